// SPDX-License-Identifier: MIT
#include "network_graph.h"

#include <fmt/format.h>

#include <optional>

#include "flattening.h"
#include "graph.h"
#include "graph_steps.h"
#include "layers.h"
#include "names.h"
#include "refusal.h"
#include "scaling_graph.h"
#include "tensor_values.h"
#include "text.h"

namespace thermorig::model {

namespace {

constexpr const char* names_advice =
    "export with input_names=['frames', 'gyro'] and output_names=['fusion', 'thermal', 'gain'], thermal-only "
    "with ['frames'] and ['thermal']";

/// The fusion's three operands (paper equation 2).
struct Operands {
  Origin gain, thermal, gyro;
};

class Reading {
 public:
  explicit Reading(const onnx::GraphProto& file) : file_(file), graph_(file), layers_(graph_) {}

  NetworkGraph network() {
    graph_.check_outputs({value::fusion, value::thermal, value::gain});
    result_.shape.fusion = graph_.output(value::fusion) != Origin{};
    const Origin maps = result_.shape.fusion ? fusion() : thermal_only();
    Origin frames = backbone(maps);
    if (frames.is("Clip")) frames = unscaled_frames(frames);
    if ((result_.speed_scale > 0.0F) != scaled_reduction_.has_value())
      throw Refusal("its graph is another network: it scales frames or speeds, and not both");
    read_frames(frames);
    check_inputs();
    result_.tensors = layers_.tensors();
    return std::move(result_);
  }

 private:
  /// Returns the input of the network. Relu and MaxPool change places without changing a value.
  Origin backbone(const Origin& maps) {
    const Origin pooled = layers_.convolution("conv2", before(graph_, maps, "Relu", "the value to flatten"),
                                              result_.shape.padding2);
    const Origin filtered = pooled.is("Relu")
                                ? layers_.pooling(before(graph_, pooled, "Relu", "the input of conv2"))
                                : before(graph_, layers_.pooling(pooled), "Relu", "the input of the pooling");
    return layers_.convolution("conv1", filtered, result_.shape.padding1);
  }

  /// The frames that a window's scaling begins with.
  Origin unscaled_frames(const Origin& scaled) {
    scaled_reduction_ = reduction_of_window_scaling(file_);
    if (!scaled_reduction_ || scaled.node->output(0) != scaled_frames_name)
      throw Refusal("its graph is another network: its frames are scaled in a way that is not known here",
                    "export it without, and say in its metadata how frames are scaled");
    return graph_.input_named(value::frames);
  }

  /// Of a network that speaks in degrees a period: speed3 * speed_scale / period.
  Origin unscaled_speed(const Origin& thermal) {
    if (!thermal.is("Div")) return thermal;
    const auto [degrees, period] = operands_of(graph_, *thermal.node);
    const auto [speed, scale] = operands_of(graph_, node_of(degrees, "Mul", "the speed"));
    if (scale.constant == nullptr) refuse_graph("the scale of the speed", scale, "a constant");
    copy_floats(*scale.constant, {}, false, {&result_.speed_scale, 1});
    if (!(result_.speed_scale > 0.0F)) throw Refusal("the scale of its speed is not above 0");
    period_ = period;
    return speed;
  }

  Origin speed_head(const Origin& thermal) {
    const Origin hidden2 =
        before(graph_, layers_.linear("speed3", unscaled_speed(thermal)), "Relu", "the input of speed3");
    const Origin hidden1 = before(graph_, layers_.linear("speed2", hidden2), "Relu", "the input of speed2");
    return flattening_.before(graph_, layers_.linear("speed1", hidden1), "the input of speed1");
  }

  Origin gain_head(const Origin& gain) {
    const Origin hidden = before(graph_, layers_.linear("gain2", before(graph_, gain, "Sigmoid", "the gain")),
                                 "Relu", "the input of gain2");
    return flattening_.before(graph_, layers_.linear("gain1", hidden), "the input of gain1");
  }

  Origin thermal_only() {
    const Origin thermal = graph_.output(value::thermal);
    if (thermal == Origin{})
      throw Refusal("its graph has neither output 'fusion' nor 'thermal'", names_advice);
    if (graph_.output(value::gain) != Origin{})
      throw Refusal("its graph has an output 'gain', but no 'fusion'", names_advice);
    return speed_head(thermal);
  }

  /// Returns what both heads begin with.
  Origin fusion() {
    const Operands found = fusion_operands(node_of(graph_.output(value::fusion), "Add", "the fusion"));
    check_output(value::thermal, found.thermal);
    check_output(value::gain, found.gain);
    gyro_ = found.gyro;
    const Origin maps = speed_head(found.thermal);
    if (gain_head(found.gain) != maps)
      throw Refusal("its graph is another network: its two heads begin with different values");
    return maps;
  }

  void check_output(std::string_view name, const Origin& expected) const {
    const Origin found = graph_.output(name);
    if (found != Origin{} && found != expected)
      throw Refusal(
          fmt::format("its graph is another network: the output '{}' is not what the fusion uses", name));
  }

  Operands fusion_operands(const onnx::NodeProto& sum) const {
    const auto [first, second] = operands_of(graph_, sum);
    for (const auto& [a, b] : {std::pair(first, second), std::pair(second, first)}) {
      if (const auto found = weighted_sum(a, b)) return *found;
      if (const auto found = correction(a, b)) return *found;
    }
    throw Refusal("its graph is another network: the fusion is not gain * thermal + (1 - gain) * gyro");
  }

  /// gain * thermal + (1 - gain) * gyro.
  std::optional<Operands> weighted_sum(const Origin& thermal_share, const Origin& gyro_share) const {
    if (!thermal_share.is("Mul") || !gyro_share.is("Mul")) return std::nullopt;
    auto [gain, thermal] = operands_of(graph_, *thermal_share.node);
    if (!gain.is("Sigmoid")) std::swap(gain, thermal);
    auto [rest, gyro] = operands_of(graph_, *gyro_share.node);
    if (!rest.is("Sub")) std::swap(rest, gyro);
    if (!gain.is("Sigmoid") || !rest.is("Sub")) return std::nullopt;
    const auto [one, subtracted] = operands_of(graph_, *rest.node);
    if (one.constant == nullptr || !is_one(*one.constant) || subtracted != gain) return std::nullopt;
    return Operands{gain, thermal, gyro};
  }

  /// gyro + gain * (thermal - gyro): the same number, as torch.lerp writes it.
  std::optional<Operands> correction(const Origin& gyro, const Origin& change) const {
    if (!change.is("Mul")) return std::nullopt;
    auto [gain, difference] = operands_of(graph_, *change.node);
    if (!gain.is("Sigmoid")) std::swap(gain, difference);
    if (!gain.is("Sigmoid") || !difference.is("Sub")) return std::nullopt;
    const auto [thermal, subtracted] = operands_of(graph_, *difference.node);
    if (subtracted != gyro) return std::nullopt;
    return Operands{gain, thermal, gyro};
  }

  static const onnx::TensorShapeProto& shape_of(const Origin& origin, std::string_view name, int rank) {
    if (origin.input == nullptr) refuse_graph(name, origin, "an input");
    if (origin.input->name() != name)
      throw Refusal(fmt::format("its input {} should be named '{}'", in_quotes(origin.input->name()), name),
                    names_advice);
    const auto& type = origin.input->type().tensor_type();
    if (type.elem_type() != onnx::TensorProto::FLOAT)
      throw Refusal(fmt::format("its input '{}' is not made of 32-bit floats", name), "export it as float32");
    if (type.shape().dim_size() != rank)
      throw Refusal(
          fmt::format("its input '{}' has {} dimensions, not {}", name, type.shape().dim_size(), rank));
    return type.shape();
  }

  void read_frames(const Origin& origin) {
    const auto& dims = shape_of(origin, value::frames, 4);
    network::Shape& shape = result_.shape;
    shape.frames = size_of(dims.dim(1));
    for (shape.reduction = network::min_reduction; shape.reduction <= network::max_reduction;
         ++shape.reduction)
      if (shape.rows() == size_of(dims.dim(2)) && shape.columns() == size_of(dims.dim(3))) break;
    if (scaled_reduction_ && shape.reduction == network::min_reduction)
      shape.reduction = *scaled_reduction_;
    else if (scaled_reduction_)
      shape.reduction = network::max_reduction + 1;
    if (shape.reduction > network::max_reduction)
      throw Refusal(fmt::format("its frames are not 24 x 32, 12 x 16 or 8 x 10 pixels but {} x {}",
                                size_of(dims.dim(2)), size_of(dims.dim(3))),
                    "only the first dimension of 'frames' may be left open when exporting");
    if (const auto fault = network::fault_of(shape)) throw Refusal("this network cannot be: " + *fault);
    flattening_.check(shape, dims.dim(0).dim_value());
  }

  /// 0 where it is left open, or too large to be anything.
  static int size_of(const onnx::TensorShapeProto::Dimension& dimension) {
    const std::int64_t size = dimension.dim_value();
    return size >= 0 && size <= 1000 ? static_cast<int>(size) : 0;
  }

  void check_inputs() const {
    const std::size_t needed = (result_.shape.fusion ? 2U : 1U) + (scaled_reduction_ ? 1U : 0U);
    if (scaled_reduction_ && size_of(shape_of(period_, value::period, 2).dim(1)) != 1)
      throw Refusal("its input 'period' is not (N, 1)");
    if (result_.shape.fusion && size_of(shape_of(gyro_, value::gyro, 2).dim(1)) != 1)
      throw Refusal("its input 'gyro' is not (N, 1)");
    if (graph_.inputs().size() != needed)
      throw Refusal(
          fmt::format("its graph has {} inputs, this network has {}", graph_.inputs().size(), needed),
          names_advice);
  }

  const onnx::GraphProto& file_;
  Graph graph_;
  Layers layers_;
  Flattening flattening_;
  NetworkGraph result_;
  Origin gyro_, period_;
  std::optional<int> scaled_reduction_;  // of a window's scaling in the graph
};

}  // namespace

NetworkGraph network_of(const onnx::GraphProto& graph) {
  return Reading(graph).network();
}

}  // namespace thermorig::model
