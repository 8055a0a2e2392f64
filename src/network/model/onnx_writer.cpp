// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <onnx/onnx_pb.h>

#include <cassert>

#include "graph_builder.h"
#include "metadata.h"
#include "names.h"
#include "scaling_graph.h"
#include "text.h"
#include "thermorig/core/frame.h"
#include "thermorig/io/files/whole_file.h"
#include "thermorig/network/model/model.h"

namespace thermorig::model {

namespace {

constexpr int written_opset = 13;  // of 2020: what every engine still in use reads
constexpr int ir_version = 8;

/// Of a network whose scaling is in the graph.
std::string description_by_window(const Model& model) {
  const network::Shape& shape = model.weights.shape;
  std::string text = fmt::format(
      "Azimuth speed of a turning thermal camera (MLX90640, 24 x 32 pixels) from {0} consecutive frames{1}.\n"
      "frames (N, {0}, 24, 32): degrees Celsius, oldest frame first.\n"
      "period (N, 1): seconds between two frames.\n",
      shape.frames, shape.fusion ? " and a gyro" : "");
  if (shape.fusion) text += "gyro (N, 1): mean of the gyro over these frames in deg/s.\n";
  text += "thermal (N, 1): speed from the frames alone, deg/s.\n";
  if (shape.fusion)
    text +=
        "gain (N, 1): Kg, 0..1, the trust in the frames.\n"
        "fusion (N, 1): Kg * thermal + (1 - Kg) * gyro, deg/s.\n";
  if (model.provenance.simulated) text += "Trained on simulated data.\n";
  return text;
}

std::string description_of(const Model& model) {
  if (model.scaling.by_window) return description_by_window(model);
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

void add_inputs_and_outputs(onnx::GraphProto& graph, const network::Shape& shape, bool by_window, int batch) {
  const int rows = by_window ? static_cast<int>(frame_rows) : shape.rows();
  const int columns = by_window ? static_cast<int>(frame_columns) : shape.columns();
  describe(*graph.add_input(), value::frames, batch, {shape.frames, rows, columns});
  if (by_window) describe(*graph.add_input(), value::period, batch, {1});
  if (shape.fusion) {
    describe(*graph.add_input(), value::gyro, batch, {1});
    describe(*graph.add_output(), value::fusion, batch, {1});
  }
  describe(*graph.add_output(), value::thermal, batch, {1});
  if (shape.fusion) describe(*graph.add_output(), value::gain, batch, {1});
}

void add_backbone(GraphBuilder& graph, const network::Shape& shape, std::string_view frames) {
  graph.add_convolution("conv1", frames, shape.padding1);
  graph.add("Relu", {"conv1"}, "conv1_relu");
  graph.add_pooling("conv1_relu", "pool");
  graph.add_convolution("conv2", "pool", shape.padding2);
  graph.add("Relu", {"conv2"}, "conv2_relu");
  graph.add("Flatten", {"conv2_relu"}, "features");
}

void add_speed_head(GraphBuilder& graph, bool by_window) {
  graph.add_linear("speed1", "features");
  graph.add("Relu", {"speed1"}, "speed1_relu");
  graph.add_linear("speed2", "speed1_relu");
  graph.add("Relu", {"speed2"}, "speed2_relu");
  if (!by_window) return graph.add_linear("speed3", "speed2_relu", value::thermal);
  graph.add_linear("speed3", "speed2_relu");
  graph.add("Mul", {"speed3", speed_scale_name}, "speed_a_period");
  graph.add("Div", {"speed_a_period", value::period}, value::thermal);
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

void fill(onnx::GraphProto& graph, const Model& model, int batch) {
  const network::Weights& weights = model.weights;
  const bool by_window = model.scaling.by_window;
  graph.set_name(weights.shape.fusion ? "thermal and gyro fusion" : "thermal odometry");
  add_inputs_and_outputs(graph, weights.shape, by_window, batch);
  GraphBuilder builder(graph);
  if (by_window) add_window_scaling(builder, weights.shape);
  add_backbone(builder, weights.shape, by_window ? scaled_frames_name : value::frames);
  add_speed_head(builder, by_window);
  for (const network::Tensor& tensor : network::tensors_of(weights.shape))
    builder.add_tensor(tensor.name, tensor.dimensions, weights.tensor(tensor.name));
  if (by_window) {
    const float speed_scale = speed_scale_of(model.scaling);
    builder.add_tensor(speed_scale_name, {}, {&speed_scale, 1});
  }
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
  // Only a foreign file has a crop, and by_window is no foreign file's.
  assert(!model.scaling.by_window || model.weights.shape.crop_left == 0);
  assert(model.weights.values.size() == network::weight_count(model.weights.shape));
  onnx::ModelProto file;
  file.set_ir_version(ir_version);
  set_producer(file, model.provenance.producer);
  file.set_doc_string(description_of(model));
  file.add_opset_import()->set_version(written_opset);
  file.mutable_opset_import(0)->set_domain("");
  fill(*file.mutable_graph(), model, batch);
  for (const auto& [key, value] : metadata_of(model)) {
    onnx::StringStringEntryProto& entry = *file.add_metadata_props();
    entry.set_key(key);
    entry.set_value(value);
  }
  return file.SerializeAsString();
}

void write_model(const std::filesystem::path& path, const Model& model, int batch) {
  files::write_whole(path, to_onnx(model, batch), "the model");
}

}  // namespace thermorig::model
