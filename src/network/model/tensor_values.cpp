// SPDX-License-Identifier: MIT
#include "tensor_values.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "refusal.h"
#include "text.h"

namespace thermorig::model {

namespace {

static_assert(std::endian::native == std::endian::little);  // as ONNX stores values

constexpr const char* export_advice = "export it with all weights inside the file, as 32-bit floats";

void check_type(const onnx::TensorProto& tensor, int type, const char* type_name) {
  if (tensor.data_location() == onnx::TensorProto::EXTERNAL || tensor.external_data_size() > 0)
    throw Refusal(
        fmt::format("the values of {} lie in another file", in_quotes(tensor.name())),
        "store them inside: onnx.save(onnx.load(path), path), or external_data=False when exporting");
  if (tensor.data_type() != type)
    throw Refusal(fmt::format("{} is not made of {}", in_quotes(tensor.name()), type_name), export_advice);
  if (tensor.has_segment())
    throw Refusal(fmt::format("{} is only a part of a tensor", in_quotes(tensor.name())), export_advice);
}

/// The values from `raw_data` or else from the typed field, whichever holds just `out.size()` of them.
template <class Value, class Typed>
void copy_values(const onnx::TensorProto& tensor, const Typed& typed, std::span<Value> out) {
  const std::string& raw = tensor.raw_data();
  const bool from_raw = tensor.has_raw_data();
  const std::size_t held = from_raw ? raw.size() : typed.size() * sizeof(Value);
  if (held != out.size_bytes() || (from_raw && !typed.empty()))
    throw Refusal(fmt::format("{} has {} bytes of values, its dimensions need {}", in_quotes(tensor.name()),
                              held, out.size_bytes()));
  const void* source = from_raw ? static_cast<const void*>(raw.data()) : typed.data();
  if (held > 0) std::memcpy(out.data(), source, held);
}

bool has_dimensions(const onnx::TensorProto& tensor, std::vector<int> dimensions, bool transposed) {
  if (transposed) std::reverse(dimensions.begin(), dimensions.end());
  return std::equal(dimensions.begin(), dimensions.end(), tensor.dims().begin(), tensor.dims().end());
}

/// Without a branch a value: the loop becomes vectors.
bool all_finite(std::span<const float> values) {
  constexpr std::uint32_t exponent = 0x7F800000U;
  std::uint32_t odd = 0;
  for (const float value : values)
    odd |= (std::bit_cast<std::uint32_t>(value) & exponent) == exponent ? 1U : 0U;
  return odd == 0;
}

std::vector<float> transpose_of(std::span<const float> values, std::size_t rows, std::size_t columns) {
  std::vector<float> transposed(values.size());
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t column = 0; column < columns; ++column)
      transposed[column * rows + row] = values[row * columns + column];
  return transposed;
}

}  // namespace

void copy_floats(const onnx::TensorProto& tensor, const std::vector<int>& dimensions, bool transposed,
                 std::span<float> out) {
  check_type(tensor, onnx::TensorProto::FLOAT, "32-bit floats");
  if (!has_dimensions(tensor, dimensions, transposed)) {
    const std::vector<std::int64_t> shown(tensor.dims().begin(),
                                          tensor.dims().begin() + std::min(tensor.dims_size(), 5));
    throw Refusal(fmt::format("{} has the dimensions ({}), not ({}){}", in_quotes(tensor.name()),
                              fmt::join(shown, ", "), fmt::join(dimensions, ", "),
                              transposed ? " transposed" : ""));
  }
  copy_values(tensor, tensor.float_data(), out);
  if (!all_finite(out))
    throw Refusal(fmt::format("{} holds NaN or infinity", in_quotes(tensor.name())),
                  "the training has diverged: train again with a smaller learning rate");
  if (!transposed) return;
  const auto turned =
      transpose_of(out, static_cast<std::size_t>(dimensions[1]), static_cast<std::size_t>(dimensions[0]));
  std::copy(turned.begin(), turned.end(), out.begin());
}

std::vector<std::int64_t> integers_of(const onnx::TensorProto& tensor) {
  check_type(tensor, onnx::TensorProto::INT64, "64-bit whole numbers");
  const std::int64_t count = tensor.dims_size() == 0 ? 1 : tensor.dims(0);
  if (tensor.dims_size() > 1 || count < 0 || count > 8)
    throw Refusal(fmt::format("{} is no short list of numbers", in_quotes(tensor.name())));
  std::vector<std::int64_t> values(static_cast<std::size_t>(count));
  copy_values(tensor, tensor.int64_data(), std::span(values));
  return values;
}

bool is_one(const onnx::TensorProto& tensor) {
  if (tensor.data_type() != onnx::TensorProto::FLOAT || tensor.dims_size() > 2) return false;
  const auto& dims = tensor.dims();
  if (!std::all_of(dims.begin(), dims.end(), [](std::int64_t size) { return size == 1; })) return false;
  check_type(tensor, onnx::TensorProto::FLOAT, "32-bit floats");
  float value = 0.0F;
  copy_values(tensor, tensor.float_data(), std::span(&value, 1));
  return value == 1.0F;
}

}  // namespace thermorig::model
