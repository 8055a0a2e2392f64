// SPDX-License-Identifier: MIT
#include "onnx_runtime.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "thermorig/core/frame.h"

namespace thermorig::interop {

namespace {

// Opaque to us: environment, session, options, memory, values and statuses are pointers.
using Handle = void*;
using Status = void*;

// Places in OrtApi, counted from its first function.
enum Place : std::size_t {
  get_error_message = 2,
  create_env = 3,
  create_session_from_array = 8,
  run_session = 9,
  create_session_options = 10,
  set_graph_optimisation = 23,
  set_intra_op_threads = 24,
  set_inter_op_threads = 25,
  create_tensor_with_data = 49,
  create_cpu_memory_info = 69
};

constexpr std::uint32_t api_version = 1;
constexpr int warnings = 2, enable_all = 99, arena_allocator = 1, default_memory = 0, float_type = 1;

struct ApiBase {
  const void* const* (*get_api)(std::uint32_t version);
  const char* (*version)();
};

[[noreturn]] void fail(const std::string& what) {
  fmt::print(stderr, "ONNX Runtime: {}\n", what);
  std::exit(1);
}

const ApiBase* open_library(const std::string& library) {
  void* opened = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (opened == nullptr) fail(dlerror());
  const auto get = reinterpret_cast<const ApiBase* (*)()>(dlsym(opened, "OrtGetApiBase"));
  if (get == nullptr) fail("no OrtGetApiBase in " + library);
  return get();
}

}  // namespace

struct OnnxRuntime::Parts {
  network::Shape shape;
  bool by_window = false;
  const ApiBase* base = nullptr;
  const void* const* api = nullptr;
  Handle session = nullptr;
  std::vector<float> frames;
  float gyro = 0.0F, period = 0.0F;
  std::array<float, 3> outputs{};
  std::vector<const char*> input_names;
  std::vector<Handle> input_values;
  std::array<Handle, 3> output_values{};

  template <typename... Argument>
  void call(Place place, Argument... arguments) const {
    const auto function = reinterpret_cast<Status (*)(Argument...)>(const_cast<void*>(api[place]));
    if (Status status = function(arguments...)) {
      const auto message =
          reinterpret_cast<const char* (*)(Status)>(const_cast<void*>(api[get_error_message]));
      fail(message(status));
    }
  }

  void open_session(std::span<const std::uint8_t> model) {
    Handle environment = nullptr, options = nullptr;
    call(create_env, warnings, "peer", &environment);
    call(create_session_options, &options);
    call(set_graph_optimisation, options, enable_all);
    call(set_intra_op_threads, options, 1);
    call(set_inter_op_threads, options, 1);
    call(create_session_from_array, environment, static_cast<const void*>(model.data()), model.size(),
         options, &session);
  }

  Handle tensor_over(Handle memory, float* values, std::size_t count,
                     const std::vector<std::int64_t>& dimensions) {
    Handle value = nullptr;
    call(create_tensor_with_data, memory, static_cast<void*>(values), count * sizeof(float),
         dimensions.data(), dimensions.size(), float_type, &value);
    return value;
  }

  void bind() {
    Handle memory = nullptr;
    call(create_cpu_memory_info, arena_allocator, default_memory, &memory);
    const std::size_t rows = by_window ? frame_rows : static_cast<std::size_t>(shape.rows());
    const std::size_t columns = by_window ? frame_columns : static_cast<std::size_t>(shape.columns());
    frames.resize(static_cast<std::size_t>(shape.frames) * rows * columns);
    const auto add = [&](const char* name, Handle value) {
      input_names.push_back(name);
      input_values.push_back(value);
    };
    add("frames",
        tensor_over(memory, frames.data(), frames.size(),
                    {1, shape.frames, static_cast<std::int64_t>(rows), static_cast<std::int64_t>(columns)}));
    if (shape.fusion) add("gyro", tensor_over(memory, &gyro, 1, {1, 1}));
    if (by_window) add("period", tensor_over(memory, &period, 1, {1, 1}));
    for (std::size_t i = 0; i < outputs.size(); ++i)
      output_values[i] = tensor_over(memory, &outputs[i], 1, {1, 1});
  }
};

OnnxRuntime::OnnxRuntime(const std::string& library, std::span<const std::uint8_t> model,
                         const network::Shape& shape, bool by_window)
    : parts_(std::make_unique<Parts>()) {
  parts_->shape = shape;
  parts_->by_window = by_window;
  parts_->base = open_library(library);
  parts_->api = parts_->base->get_api(api_version);
  if (parts_->api == nullptr) fail("its C interface is too new");
  parts_->open_session(model);
  parts_->bind();
}

OnnxRuntime::~OnnxRuntime() = default;  // the process ends soon after: its session is left to it

std::string OnnxRuntime::version() const {
  return parts_->base->version();
}

std::span<float> OnnxRuntime::frames() {
  return parts_->frames;
}

float& OnnxRuntime::gyro() {
  return parts_->gyro;
}

float& OnnxRuntime::period() {
  return parts_->period;
}

network::Output OnnxRuntime::run() {
  static constexpr std::array fusion_outputs{"fusion", "thermal", "gain"};
  static constexpr std::array thermal_outputs{"thermal"};
  const bool fusion = parts_->shape.fusion;
  const char* const* names = fusion ? fusion_outputs.data() : thermal_outputs.data();
  parts_->call(run_session, parts_->session, Handle{nullptr}, parts_->input_names.data(),
               parts_->input_values.data(), parts_->input_values.size(), names, std::size_t{fusion ? 3U : 1U},
               parts_->output_values.data());
  const auto& outputs = parts_->outputs;
  if (!fusion) return {outputs[0], outputs[0], 1.0F};
  return {outputs[0], outputs[1], outputs[2]};
}

}  // namespace thermorig::interop
