// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <google/protobuf/stubs/logging.h>
#include <onnx/onnx_pb.h>

#include <algorithm>

#include "metadata.h"
#include "network_graph.h"
#include "refusal.h"
#include "scaling_graph.h"
#include "tensor_values.h"
#include "text.h"
#include "thermorig/core/error.h"
#include "thermorig/core/git_lfs.h"
#include "thermorig/io/files/whole_file.h"
#include "thermorig/network/model/model.h"

namespace thermorig::model {

namespace {

constexpr const char* usual_advice =
    "give a model that thermorig train has written, or one exported as docs/model_format.md says";

/// The largest network has 751,000 weights, 3 MB; somebody else's exporter may add text. Larger files are
/// refused before they are read: a field of two bytes may become a message of 150 in memory.
constexpr std::size_t file_bytes_max = std::size_t{8} << 20U;

bool begins_with(std::span<const std::uint8_t> bytes, std::string_view start) {
  return bytes.size() >= start.size() &&
         std::equal(start.begin(), start.end(), bytes.begin(),
                    [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
}

/// ONNX has no mark at its beginning; other files that are likely here have.
void check_kind(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) throw Refusal("it is empty");
  if (bytes.size() > file_bytes_max)
    throw Refusal(fmt::format("it has {} MB; a model of this network has 4 at most", bytes.size() >> 20U));
  if (begins_with(bytes, "\x89HDF")) throw Refusal("it is an HDF5 file, perhaps a session, not a model");
  if (is_git_lfs_pointer({reinterpret_cast<const char*>(bytes.data()), bytes.size()}))
    throw Refusal("it is a Git LFS pointer: the file itself was not fetched", git_lfs_advice);
  if (begins_with(bytes, "PK"))
    throw Refusal("it is a zip archive, perhaps PyTorch's own kind of file, not ONNX",
                  "export the network with torch.onnx.export: docs/model_format.md shows how");
}

onnx::ModelProto parse(std::span<const std::uint8_t> bytes) {
  const google::protobuf::LogSilencer silencer;
  onnx::ModelProto file;
  if (!file.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())))
    throw Refusal("it is not an ONNX file, a damaged one, or one that was cut off",
                  "copy or export it again");
  const onnx::GraphProto& graph = file.graph();
  if (file.functions_size() + file.training_info_size() + graph.quantization_annotation_size() +
          graph.sparse_initializer_size() >
      0)
    throw Refusal("its graph has functions, sparse or quantised tensors, which this network has not");
  return file;
}

/// From opset 9 on (2018) the operators of this network mean what they mean today; 22 is the newest at the
/// time of writing.
void check_versions(const onnx::ModelProto& file) {
  if (!file.has_graph()) throw Refusal("it is not an ONNX file: it has no graph");
  int standard = 0;
  for (const auto& set : file.opset_import()) {
    if (!set.domain().empty() && set.domain() != "ai.onnx") continue;
    ++standard;
    if (set.version() < 9 || set.version() > 22)
      throw Refusal(fmt::format("it is made for version {} of ONNX's operators", set.version()),
                    "export it with an opset_version from 9 to 22, best 13");
  }
  if (standard != 1) throw Refusal("it does not say which version of ONNX's operators it is made for");
}

std::vector<std::pair<std::string, std::string>> entries_of(const onnx::ModelProto& file) {
  std::vector<std::pair<std::string, std::string>> entries;
  for (const auto& entry : file.metadata_props()) entries.emplace_back(entry.key(), entry.value());
  return entries;
}

network::Weights weights_of(const NetworkGraph& graph, const network::Shape& shape) {
  network::Weights weights{shape, std::vector<float>(network::weight_count(shape))};
  for (const network::Tensor& tensor : network::tensors_of(shape)) {
    const TensorSource& source = graph.tensors.at(std::string(tensor.name));
    copy_floats(*source.tensor, tensor.dimensions, source.transposed, weights.tensor(tensor.name));
  }
  return weights;
}

std::string producer_of(const onnx::ModelProto& file) {
  const std::string& name = file.producer_name();
  const std::string& version = file.producer_version();
  return plain_text(version.empty() ? name : name + " " + version);
}

/// What a graph does to frames and speeds, its metadata must say, for that is what is done here.
void check_scaling(const NetworkGraph& graph, const network::Scaling& scaling, bool ours, int crop_left) {
  const bool in_graph = graph.speed_scale > 0.0F;
  if (in_graph && !scaling.by_window)
    throw Refusal("its graph scales each window by itself, and its metadata does not say so");
  if (in_graph && graph.speed_scale != speed_scale_of(scaling))
    throw Refusal("its graph scales speeds otherwise than label_scale_dps and frame_period_s say");
  if (!in_graph && ours && scaling.by_window)
    throw Refusal("its metadata says that scaling is in the graph, and it is not");
  if (in_graph && crop_left != 0)
    throw Refusal("its graph averages from the first column on, and its metadata has a crop_left");
}

Model model_of(std::span<const std::uint8_t> bytes) {
  check_kind(bytes);
  const onnx::ModelProto file = parse(bytes);
  check_versions(file);
  const NetworkGraph graph = network_of(file.graph());
  const Metadata metadata(entries_of(file));
  network::Shape shape = graph.shape;
  metadata.complete(shape);
  Model model{weights_of(graph, shape), metadata.scaling(), metadata.provenance(producer_of(file))};
  check_scaling(graph, model.scaling, metadata.is_ours(), shape.crop_left);
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

Model read_model(const std::filesystem::path& path) {
  return from_onnx(files::read_whole(path, file_bytes_max, "the model"), path.string());
}

}  // namespace thermorig::model
