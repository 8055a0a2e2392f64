// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <onnx/onnx_pb.h>

#include <cassert>

#include "graph.h"
#include "metadata.h"
#include "text.h"
#include "thermorig/network/model/model.h"

namespace thermorig::model {

namespace {

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

/// "thermorig 0.1.0" is a name and a version to ONNX.
void set_producer(onnx::ModelProto& file, const std::string& producer) {
  const std::size_t space = producer.find(' ');
  file.set_producer_name(plain_text(producer.substr(0, space)));
  if (space != std::string::npos) file.set_producer_version(plain_text(producer.substr(space + 1)));
}

}  // namespace

std::string to_onnx(const Model& model, int batch) {
  assert(!network::fault_of(model.weights.shape));
  assert(!model.scaling.by_window || model.weights.shape.crop_left == 0);
  assert(model.weights.values.size() == network::weight_count(model.weights.shape));
  onnx::ModelProto file;
  file.set_ir_version(ir_version);
  set_producer(file, model.provenance.producer);
  file.set_doc_string(description_of(model));
  file.add_opset_import()->set_version(opset);
  file.mutable_opset_import(0)->set_domain("");
  fill_graph(*file.mutable_graph(), model.weights, model.scaling, batch);
  for (const auto& [key, value] : metadata_of(model)) {
    onnx::StringStringEntryProto& entry = *file.add_metadata_props();
    entry.set_key(key);
    entry.set_value(value);
  }
  return file.SerializeAsString();
}

}  // namespace thermorig::model
