// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <google/protobuf/stubs/logging.h>
#include <onnx/onnx_pb.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "graph.h"
#include "metadata.h"
#include "names.h"
#include "refusal.h"
#include "text.h"
#include "thermorig/core/error.h"
#include "thermorig/core/git_lfs.h"
#include "thermorig/io/files/whole_file.h"
#include "thermorig/network/model/model.h"

namespace thermorig::model {

namespace {

constexpr const char* usual_advice =
    "give a model that thermorig train has written, or one made as docs/model_format.md says";

/// The largest network has 751,000 weights, 3 MB. Larger files are refused before they are read: a field of
/// two bytes may become a message of 150 in memory.
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
                  "docs/model_format.md shows how its weights become a model");
}

onnx::ModelProto parse(std::span<const std::uint8_t> bytes) {
  const google::protobuf::LogSilencer silencer;
  onnx::ModelProto file;
  if (!file.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())))
    throw Refusal("it is no ONNX file, a damaged one, or one that was cut off", "copy or export it again");
  const onnx::GraphProto& graph = file.graph();
  if (file.functions_size() + file.training_info_size() + graph.quantization_annotation_size() +
          graph.sparse_initializer_size() >
      0)
    throw Refusal("its graph has functions, sparse or quantised tensors, which this network has not");
  return file;
}

void check_versions(const onnx::ModelProto& file) {
  if (!file.has_graph()) throw Refusal("it is no ONNX file: it has no graph");
  if (file.opset_import_size() != 1 || !file.opset_import(0).domain().empty() ||
      file.opset_import(0).version() != opset)
    throw Refusal(fmt::format("it is not made for version {} of ONNX's operators", opset));
}

std::vector<std::pair<std::string, std::string>> entries_of(const onnx::ModelProto& file) {
  std::vector<std::pair<std::string, std::string>> entries;
  for (const auto& entry : file.metadata_props()) entries.emplace_back(entry.key(), entry.value());
  return entries;
}

const onnx::TensorProto& tensor_of(const onnx::GraphProto& graph, std::string_view name) {
  const auto found = std::ranges::find(graph.initializer(), name, &onnx::TensorProto::name);
  if (found == graph.initializer().end()) throw Refusal(fmt::format("it has no tensor '{}'", name));
  return *found;
}

/// Without a branch a value: the loop becomes vectors.
bool all_finite(std::span<const float> values) {
  constexpr std::uint32_t exponent = 0x7F800000U;
  std::uint32_t odd = 0;
  for (const float value : values)
    odd |= (std::bit_cast<std::uint32_t>(value) & exponent) == exponent ? 1U : 0U;
  return odd == 0;
}

/// Copies a tensor of just these dimensions, whose values lie in the file as they lie in memory.
void copy_floats(const onnx::TensorProto& tensor, const std::vector<int>& dimensions, std::span<float> out) {
  static_assert(std::endian::native == std::endian::little);
  const std::string name = in_quotes(tensor.name());
  if (tensor.data_type() != onnx::TensorProto::FLOAT || tensor.float_data_size() > 0)
    throw Refusal(fmt::format("{} is not made of 32-bit floats as raw data", name));
  if (!std::ranges::equal(tensor.dims(), dimensions)) {
    const std::vector<std::int64_t> shown(tensor.dims().begin(),
                                          tensor.dims().begin() + std::min(tensor.dims_size(), 5));
    throw Refusal(fmt::format("{} has the dimensions ({}), not ({})", name, fmt::join(shown, ", "),
                              fmt::join(dimensions, ", ")));
  }
  const std::string& raw = tensor.raw_data();
  if (raw.size() != out.size_bytes())
    throw Refusal(
        fmt::format("{} has {} bytes of values, its dimensions need {}", name, raw.size(), out.size_bytes()));
  std::memcpy(out.data(), raw.data(), raw.size());
  if (!all_finite(out))
    throw Refusal(fmt::format("{} holds NaN or infinity", name),
                  "the training has diverged: train again with a smaller learning rate");
}

network::Weights weights_of(const onnx::GraphProto& graph, const network::Shape& shape) {
  network::Weights weights{shape, std::vector<float>(network::weight_count(shape))};
  for (const network::Tensor& tensor : network::tensors_of(shape))
    copy_floats(tensor_of(graph, tensor.name), tensor.dimensions, weights.tensor(tensor.name));
  return weights;
}

std::string producer_of(const onnx::ModelProto& file) {
  const std::string& name = file.producer_name();
  const std::string& version = file.producer_version();
  return plain_text(version.empty() ? name : name + " " + version);
}

Model model_of(std::span<const std::uint8_t> bytes) {
  check_kind(bytes);
  const onnx::ModelProto file = parse(bytes);
  check_versions(file);
  const Metadata metadata(entries_of(file));
  const network::Shape shape = metadata.shape();
  const network::Scaling scaling = metadata.scaling();
  require_graph(file.graph(), shape, scaling);
  Model model{weights_of(file.graph(), shape), scaling, metadata.provenance(producer_of(file))};
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

void write_model(const std::filesystem::path& path, const Model& model, int batch) {
  files::write_whole(path, to_onnx(model, batch), "the model");
}

Model read_model(const std::filesystem::path& path) {
  return from_onnx(files::read_whole(path, file_bytes_max, "the model"), path.string());
}

}  // namespace thermorig::model
