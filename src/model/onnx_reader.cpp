// SPDX-License-Identifier: MIT
#include <google/protobuf/stubs/logging.h>
#include <onnx/onnx_pb.h>

#include <map>

#include "metadata.h"
#include "names.h"
#include "refusal.h"
#include "tensor_values.h"
#include "text.h"
#include "thermorig/core/error.h"
#include "thermorig/model/model.h"

namespace thermorig::model {

namespace {

constexpr const char* usual_advice =
    "give a model that thermorig train has written, or one exported as docs/model_format.md says";

onnx::ModelProto parse(std::span<const std::uint8_t> bytes) {
  const google::protobuf::LogSilencer silencer;
  onnx::ModelProto file;
  if (!file.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())))
    throw Refusal("it is no ONNX file, or a damaged one");
  return file;
}

std::vector<std::pair<std::string, std::string>> entries_of(const onnx::ModelProto& file) {
  std::vector<std::pair<std::string, std::string>> entries;
  for (const auto& entry : file.metadata_props()) entries.emplace_back(entry.key(), entry.value());
  return entries;
}

network::Shape shape_of(const onnx::ModelProto& file) {
  std::map<std::string, std::string> said;
  for (const auto& entry : file.metadata_props()) said[entry.key()] = entry.value();
  const auto number = [&](std::string_view key) { return std::atoi(said[std::string(key)].c_str()); };
  network::Shape shape{number(key::frames),   number(key::reduction), said["network"] == "fusion",
                       number(key::padding1), number(key::padding2),  number(key::crop_left)};
  if (const auto fault = network::fault_of(shape)) throw Refusal(*fault);
  return shape;
}

network::Weights weights_of(const onnx::ModelProto& file, const network::Shape& shape) {
  network::Weights weights{shape, {}};
  std::map<std::string, const onnx::TensorProto*> tensors;
  for (const auto& tensor : file.graph().initializer()) tensors[tensor.name()] = &tensor;
  weights.values.resize(network::weight_count(shape));
  for (const network::Tensor& tensor : network::tensors_of(shape)) {
    const auto found = tensors.find(std::string(tensor.name));
    if (found == tensors.end()) throw Refusal("it lacks " + in_quotes(tensor.name));
    copy_floats(*found->second, tensor.dimensions, false, weights.tensor(tensor.name));
  }
  return weights;
}

std::string producer_of(const onnx::ModelProto& file) {
  const std::string name = file.producer_name(), version = file.producer_version();
  return plain_text(version.empty() ? name : name + " " + version);
}

Model model_of(std::span<const std::uint8_t> bytes) {
  const onnx::ModelProto file = parse(bytes);
  const Metadata metadata(entries_of(file));
  network::Shape shape = shape_of(file);
  metadata.complete(shape);
  Model model{weights_of(file, shape), metadata.scaling(), metadata.provenance(producer_of(file))};
  metadata.check(model.weights);
  return model;
}

}  // namespace

Model from_onnx(std::span<const std::uint8_t> bytes, const std::string& where) {
  try {
    return model_of(bytes);
  } catch (const Refusal& refusal) {
    throw Error(ExitCode::not_a_session, refusal.what(), where,
                refusal.advice().empty() ? usual_advice : refusal.advice());
  }
}

}  // namespace thermorig::model
