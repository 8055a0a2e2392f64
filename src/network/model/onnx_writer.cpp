// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <onnx/onnx_pb.h>

#include <bit>
#include <cassert>
#include <initializer_list>

#include "metadata.h"
#include "names.h"
#include "text.h"
#include "thermorig/network/model/model.h"

namespace thermorig::model {

namespace {

using Names = std::initializer_list<std::string_view>;

// The values of a tensor are stored as they lie in memory; ONNX asks for little endian.
static_assert(std::endian::native == std::endian::little);

constexpr int written_opset = 13;  // of 2020: what every engine still in use reads
constexpr int ir_version = 8;

std::string description_of(const Model& model) {
  const network::Shape& shape = model.weights.shape;
  std::string text = fmt::format(
      "Azimuth speed of a turning thermal camera (MLX90640, 24 x 32 pixels) from {} consecutive frames{}.\n"
      "frames (N, {}, {}, {}): oldest frame first, pixels averaged {} x {}, then (deg C - {}) / {}.\n",
      shape.frames, shape.fusion ? " and a gyro" : "", shape.frames, shape.rows(), shape.columns(),
      shape.reduction, shape.reduction, model.scaling.temp_mean_c, model.scaling.temp_deviation_c);
  if (shape.fusion)
    text += fmt::format("gyro (N, 1): mean of the gyro over these frames in deg/s, divided by {}.\n",
                        model.scaling.label_scale_dps);
  text += fmt::format("thermal (N, 1): speed from the frames alone; times {} it is deg/s.\n",
                      model.scaling.label_scale_dps);
  if (shape.fusion)
    text +=
        "gain (N, 1): Kg, 0..1, the trust in the frames.\n"
        "fusion (N, 1): Kg * thermal + (1 - Kg) * gyro; scaled as thermal.\n";
  if (model.provenance.simulated) text += "Trained on simulated data.\n";
  return text;
}

/// Builds the graph; each `add` appends, so the order of the calls is the order of the file.
class GraphBuilder {
 public:
  explicit GraphBuilder(onnx::GraphProto& graph) : graph_(graph) {}

  onnx::NodeProto& add(const char* operation, Names inputs, std::string_view output) {
    onnx::NodeProto& node = *graph_.add_node();
    for (const std::string_view input : inputs) node.add_input(std::string(input));
    node.add_output(std::string(output));
    node.set_name(std::string(output));
    node.set_op_type(operation);
    return node;
  }

  void add_convolution(std::string_view layer, std::string_view input, int padding) {
    const std::string name(layer);
    onnx::NodeProto& node = add("Conv", {input, name + ".weight", name + ".bias"}, name);
    set(node, "kernel_shape", {network::kernel_size, network::kernel_size});
    set(node, "pads", {padding, padding, padding, padding});
    set(node, "strides", {1, 1});
  }

  void add_pooling(std::string_view input, std::string_view output) {
    onnx::NodeProto& node = add("MaxPool", {input}, output);
    set(node, "kernel_shape", {2, 2});
    set(node, "pads", {0, 0, 0, 0});
    set(node, "strides", {2, 2});
  }

  /// y = x W^T + b, as PyTorch's Linear. `output` is the layer's own name where nothing else is said.
  void add_linear(std::string_view layer, std::string_view input, std::string_view output = "") {
    const std::string name(layer);
    onnx::NodeProto& node =
        add("Gemm", {input, name + ".weight", name + ".bias"}, output.empty() ? layer : output);
    onnx::AttributeProto& transposed = *node.add_attribute();
    transposed.set_name("transB");
    transposed.set_type(onnx::AttributeProto::INT);
    transposed.set_i(1);
  }

  void add_tensor(std::string_view name, const std::vector<int>& dimensions, std::span<const float> values) {
    onnx::TensorProto& tensor = *graph_.add_initializer();
    for (const int dimension : dimensions) tensor.add_dims(dimension);
    tensor.set_data_type(onnx::TensorProto::FLOAT);
    tensor.set_name(std::string(name));
    tensor.set_raw_data(values.data(), values.size_bytes());
  }

 private:
  static void set(onnx::NodeProto& node, const char* name, std::initializer_list<int> values) {
    onnx::AttributeProto& attribute = *node.add_attribute();
    attribute.set_name(name);
    attribute.set_type(onnx::AttributeProto::INTS);
    for (const int value : values) attribute.add_ints(value);
  }

  onnx::GraphProto& graph_;
};

void describe(onnx::ValueInfoProto& value, std::string_view name, int batch, const std::vector<int>& rest) {
  value.set_name(std::string(name));
  onnx::TypeProto::Tensor& type = *value.mutable_type()->mutable_tensor_type();
  type.set_elem_type(onnx::TensorProto::FLOAT);
  onnx::TensorShapeProto& shape = *type.mutable_shape();
  if (batch > 0)
    shape.add_dim()->set_dim_value(batch);
  else
    shape.add_dim()->set_dim_param("N");
  for (const int dimension : rest) shape.add_dim()->set_dim_value(dimension);
}

void add_inputs_and_outputs(onnx::GraphProto& graph, const network::Shape& shape, int batch) {
  describe(*graph.add_input(), value::frames, batch, {shape.frames, shape.rows(), shape.columns()});
  if (shape.fusion) {
    describe(*graph.add_input(), value::gyro, batch, {1});
    describe(*graph.add_output(), value::fusion, batch, {1});
  }
  describe(*graph.add_output(), value::thermal, batch, {1});
  if (shape.fusion) describe(*graph.add_output(), value::gain, batch, {1});
}

void add_backbone(GraphBuilder& graph, const network::Shape& shape) {
  graph.add_convolution("conv1", value::frames, shape.padding1);
  graph.add("Relu", {"conv1"}, "conv1_relu");
  graph.add_pooling("conv1_relu", "pool");
  graph.add_convolution("conv2", "pool", shape.padding2);
  graph.add("Relu", {"conv2"}, "conv2_relu");
  graph.add("Flatten", {"conv2_relu"}, "features");
}

void add_speed_head(GraphBuilder& graph) {
  graph.add_linear("speed1", "features");
  graph.add("Relu", {"speed1"}, "speed1_relu");
  graph.add_linear("speed2", "speed1_relu");
  graph.add("Relu", {"speed2"}, "speed2_relu");
  graph.add_linear("speed3", "speed2_relu", value::thermal);
}

/// The gain head and the fusion, paper equation 2.
void add_fusion(GraphBuilder& graph) {
  graph.add_linear("gain1", "features");
  graph.add("Relu", {"gain1"}, "gain1_relu");
  graph.add_linear("gain2", "gain1_relu");
  graph.add("Sigmoid", {"gain2"}, value::gain);
  graph.add("Mul", {value::gain, value::thermal}, "thermal_share");
  graph.add("Sub", {"one", value::gain}, "gyro_gain");
  graph.add("Mul", {"gyro_gain", value::gyro}, "gyro_share");
  graph.add("Add", {"thermal_share", "gyro_share"}, value::fusion);
}

void fill(onnx::GraphProto& graph, const network::Weights& weights, int batch) {
  graph.set_name(weights.shape.fusion ? "thermal and gyro fusion" : "thermal odometry");
  add_inputs_and_outputs(graph, weights.shape, batch);
  GraphBuilder builder(graph);
  add_backbone(builder, weights.shape);
  add_speed_head(builder);
  for (const network::Tensor& tensor : network::tensors_of(weights.shape))
    builder.add_tensor(tensor.name, tensor.dimensions, weights.tensor(tensor.name));
  if (!weights.shape.fusion) return;
  add_fusion(builder);
  constexpr float one = 1.0F;
  builder.add_tensor("one", {}, {&one, 1});
}

/// "thermorig 0.1.0" is a name and a version to ONNX.
void set_producer(onnx::ModelProto& file, const std::string& producer) {
  const std::size_t space = producer.find(' ');
  file.set_producer_name(plain_text(producer.substr(0, space)));
  if (space != std::string::npos) file.set_producer_version(plain_text(producer.substr(space + 1)));
}

}  // namespace

std::string to_onnx(const Model& model, int batch) {
  assert(!network::fault_of(model.weights.shape));
  assert(model.weights.values.size() == network::weight_count(model.weights.shape));
  onnx::ModelProto file;
  file.set_ir_version(ir_version);
  set_producer(file, model.provenance.producer);
  file.set_doc_string(description_of(model));
  file.add_opset_import()->set_version(written_opset);
  file.mutable_opset_import(0)->set_domain("");
  fill(*file.mutable_graph(), model.weights, batch);
  for (const auto& [key, value] : metadata_of(model)) {
    onnx::StringStringEntryProto& entry = *file.add_metadata_props();
    entry.set_key(key);
    entry.set_value(value);
  }
  return file.SerializeAsString();
}

}  // namespace thermorig::model
