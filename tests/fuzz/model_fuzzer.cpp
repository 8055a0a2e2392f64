// SPDX-License-Identifier: MIT
// Any bytes as a model file: refused with exit code 8, or a sound model that comes back the same after it has
// been written. Since weights are most of a file and a fuzzer likes short inputs, tensors without values are
// given some.
#include <onnx/onnx_pb.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>

#include "thermorig/core/error.h"
#include "thermorig/network/model/model.h"

namespace {

using namespace thermorig;

void require(bool holds) {
  if (!holds) std::abort();
}

void check(const model::Model& read) {
  require(!network::fault_of(read.weights.shape));
  require(read.weights.values.size() == network::weight_count(read.weights.shape));
  for (const float value : read.weights.values) require(std::isfinite(value));
  require(read.scaling.temp_deviation_c > 0.0F && std::isfinite(read.scaling.temp_mean_c));
  const std::string written = model::to_onnx(read);
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(written.data());
  const model::Model again = model::from_onnx({bytes, written.size()}, "written");
  require(again.weights == read.weights && again.scaling == read.scaling);
  require(model::to_onnx(again) == written);
}

void read(std::span<const std::uint8_t> bytes) {
  try {
    check(model::from_onnx(bytes, "fuzz"));
  } catch (const Error& error) {
    require(error.code() == ExitCode::not_a_session && !error.advice().empty());
  }
}

void fill(onnx::TensorProto& tensor) {
  constexpr std::int64_t most = 400'000;
  std::int64_t size = 1;
  for (const std::int64_t dimension : tensor.dims()) {
    if (dimension < 0 || dimension > most) return;
    size = std::min(size * dimension, most);
  }
  if (!tensor.has_raw_data() && tensor.data_type() == onnx::TensorProto::FLOAT)
    tensor.set_raw_data(std::string(static_cast<std::size_t>(4 * size), '\0'));
}

/// The same file with values; nothing if it is none or would become large.
std::string filled(std::span<const std::uint8_t> bytes) {
  onnx::ModelProto file;
  if (!file.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) return "";
  auto& tensors = *file.mutable_graph()->mutable_initializer();
  if (tensors.size() > 20) return "";
  for (auto& tensor : tensors) fill(tensor);
  return file.SerializeAsString();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  google::protobuf::SetLogHandler(nullptr);
  read({data, size});
  const std::string file = filled({data, size});
  read({reinterpret_cast<const std::uint8_t*>(file.data()), file.size()});
  return 0;
}
