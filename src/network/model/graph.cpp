// SPDX-License-Identifier: MIT
#include "graph.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "names.h"
#include "refusal.h"
#include "text.h"
#include "thermorig/core/frame.h"

namespace thermorig::model {

namespace {

constexpr std::string_view scaled_frames_name = "scaled_frames", speed_scale_name = "speed_scale";

// The values of a tensor are stored as they lie in memory; ONNX asks for little endian.
static_assert(std::endian::native == std::endian::little);

using Names = std::initializer_list<std::string_view>;

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
    set(node, "transB", 1);
  }

  void add_integers(std::string_view name, std::initializer_list<std::int64_t> values) {
    onnx::TensorProto& tensor = *graph_.add_initializer();
    tensor.add_dims(static_cast<std::int64_t>(values.size()));
    tensor.set_data_type(onnx::TensorProto::INT64);
    tensor.set_name(std::string(name));
    tensor.set_raw_data(values.begin(), values.size() * sizeof(std::int64_t));
  }

  void add_tensor(std::string_view name, const std::vector<int>& dimensions, std::span<const float> values) {
    onnx::TensorProto& tensor = *graph_.add_initializer();
    for (const int dimension : dimensions) tensor.add_dims(dimension);
    tensor.set_data_type(onnx::TensorProto::FLOAT);
    tensor.set_name(std::string(name));
    tensor.set_raw_data(values.data(), values.size_bytes());
  }

  static void set(onnx::NodeProto& node, const char* name, std::initializer_list<int> values) {
    onnx::AttributeProto& attribute = *node.add_attribute();
    attribute.set_name(name);
    attribute.set_type(onnx::AttributeProto::INTS);
    for (const int value : values) attribute.add_ints(value);
  }

  static void set(onnx::NodeProto& node, const char* name, int value) {
    onnx::AttributeProto& attribute = *node.add_attribute();
    attribute.set_name(name);
    attribute.set_type(onnx::AttributeProto::INT);
    attribute.set_i(value);
  }

 private:
  onnx::GraphProto& graph_;
};

// ---- network::scale_window() in operators of ONNX, from frames of the camera on
// ----------------------------

constexpr int rounds = 4;

/// A round's values have its number behind their names.
class Rounds {
 public:
  Rounds(GraphBuilder& graph, std::string_view frames) : graph_(graph), frames_(frames) {}

  void first() {
    GraphBuilder::set(graph_.add("ReduceMean", {frames_}, "row_mean_1"), "axes", {1, 3});
    graph_.add("Sub", {frames_, "row_mean_1"}, "off_1");
    graph_.add("Mul", {"off_1", "off_1"}, "square_1");
    GraphBuilder::set(graph_.add("ReduceMean", {"square_1"}, "variance_1"), "axes", {1, 2, 3});
    deviation(1);
  }

  void next(int round) {
    const auto now = [round](const char* name) { return fmt::format("{}_{}", name, round); };
    const auto before = [round](const char* name) { return fmt::format("{}_{}", name, round - 1); };
    graph_.add("Mul", {before("deviation"), "outlier"}, now("limit"));
    graph_.add("Abs", {before("off")}, now("size"));
    graph_.add("LessOrEqual", {now("size"), now("limit")}, now("within"));
    GraphBuilder::set(graph_.add("Cast", {now("within")}, now("counts")), "to", onnx::TensorProto::FLOAT);
    graph_.add("ReduceSum", {now("counts"), "axes_of_row"}, now("in_row"));
    graph_.add("Max", {now("in_row"), "least_count"}, now("row_count"));
    graph_.add("Mul", {before("off"), now("counts")}, now("counted"));
    graph_.add("ReduceSum", {now("counted"), "axes_of_row"}, now("row_sum"));
    graph_.add("Div", {now("row_sum"), now("row_count")}, now("shift"));
    graph_.add("Add", {before("row_mean"), now("shift")}, now("row_mean"));
    graph_.add("Sub", {frames_, now("row_mean")}, now("off"));
    graph_.add("Mul", {now("off"), now("off")}, now("all_squares"));
    graph_.add("Mul", {now("all_squares"), now("counts")}, now("square"));
    graph_.add("ReduceSum", {now("square"), "axes_of_window"}, now("square_sum"));
    graph_.add("ReduceSum", {now("counts"), "axes_of_window"}, now("in_window"));
    graph_.add("Max", {now("in_window"), "least_count"}, now("window_count"));
    graph_.add("Div", {now("square_sum"), now("window_count")}, now("variance"));
    deviation(round);
  }

 private:
  void deviation(int round) {
    const std::string root = fmt::format("root_{}", round);
    graph_.add("Sqrt", {fmt::format("variance_{}", round)}, root);
    graph_.add("Max", {root, "least_deviation"}, fmt::format("deviation_{}", round));
  }

  GraphBuilder& graph_;
  std::string_view frames_;
};

void add_number(GraphBuilder& graph, std::string_view name, float value) {
  graph.add_tensor(name, {}, {&value, 1});
}

void add_window_scaling(GraphBuilder& graph, const network::Shape& shape) {
  const bool averaged = shape.reduction > 1;
  if (averaged) {
    onnx::NodeProto& node = graph.add("AveragePool", {value::frames}, "averaged");
    GraphBuilder::set(node, "kernel_shape", {shape.reduction, shape.reduction});
    GraphBuilder::set(node, "strides", {shape.reduction, shape.reduction});
  }
  Rounds round(graph, averaged ? "averaged" : value::frames);
  round.first();
  for (int number = 2; number <= rounds; ++number) round.next(number);
  graph.add("Div", {fmt::format("off_{}", rounds), fmt::format("deviation_{}", rounds)}, "unclamped");
  graph.add("Clip", {"unclamped", "least_scaled", "most_scaled"}, scaled_frames_name);
  graph.add_integers("axes_of_row", {1, 3});
  graph.add_integers("axes_of_window", {1, 2, 3});
  add_number(graph, "outlier", 3.0F);
  add_number(graph, "least_count", 1.0F);
  add_number(graph, "least_deviation", 0.01F);
  add_number(graph, "least_scaled", -4.0F);
  add_number(graph, "most_scaled", 4.0F);
}

// ---- the network
// -------------------------------------------------------------------------------------------

void describe(onnx::ValueInfoProto& value, std::string_view name, std::int64_t batch,
              const std::vector<int>& rest) {
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

void add_inputs_and_outputs(onnx::GraphProto& graph, const network::Shape& shape, bool by_window,
                            std::int64_t batch) {
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

/// Parts of one kind, byte for byte; `name_of` says which one differs.
template <typename Parts, typename NameOf>
void require_same(const Parts& found, const Parts& expected, const char* kind, NameOf name_of) {
  for (int i = 0; i < expected.size(); ++i)
    if (i >= found.size() || found.at(i).SerializeAsString() != expected.at(i).SerializeAsString())
      throw Refusal(fmt::format("its graph is another network: its {} {} differs", kind,
                                in_quotes(name_of(expected.at(i)))));
  if (found.size() > expected.size())
    throw Refusal(fmt::format("its graph is another network: it has {} {}s, not {}", found.size(), kind,
                              expected.size()));
}

/// What is no weight: numbers of the scaling, of the fusion.
void require_same_constants(const onnx::GraphProto& found, const onnx::GraphProto& expected) {
  for (const onnx::TensorProto& constant : expected.initializer()) {
    const auto same = std::ranges::find(found.initializer(), constant.name(), &onnx::TensorProto::name);
    if (same == found.initializer().end() || same->SerializeAsString() != constant.SerializeAsString())
      throw Refusal(fmt::format("its graph is another network: its constant {} is not what its metadata says",
                                in_quotes(constant.name())));
  }
}

}  // namespace

void fill_graph(onnx::GraphProto& graph, const network::Weights& weights, const network::Scaling& scaling,
                std::int64_t batch) {
  const network::Shape& shape = weights.shape;
  graph.set_name(shape.fusion ? "thermal and gyro fusion" : "thermal odometry");
  add_inputs_and_outputs(graph, shape, scaling.by_window, batch);
  GraphBuilder builder(graph);
  if (scaling.by_window) add_window_scaling(builder, shape);
  add_backbone(builder, shape, scaling.by_window ? scaled_frames_name : value::frames);
  add_speed_head(builder, scaling.by_window);
  if (!weights.values.empty())
    for (const network::Tensor& tensor : network::tensors_of(shape))
      builder.add_tensor(tensor.name, tensor.dimensions, weights.tensor(tensor.name));
  if (scaling.by_window)
    add_number(builder, speed_scale_name, scaling.label_scale_dps * scaling.frame_period_s);
  if (!shape.fusion) return;
  add_fusion(builder);
  add_number(builder, "one", 1.0F);
}

void require_graph(const onnx::GraphProto& graph, const network::Shape& shape,
                   const network::Scaling& scaling) {
  const auto& dims = graph.input_size() > 0 ? graph.input(0).type().tensor_type().shape().dim()
                                            : onnx::TensorShapeProto::default_instance().dim();
  onnx::GraphProto expected;
  fill_graph(expected, {shape, {}}, scaling,
             dims.empty() ? 0 : std::max<std::int64_t>(dims.at(0).dim_value(), 0));
  require_same(graph.input(), expected.input(), "input", [](const auto& input) { return input.name(); });
  require_same(graph.node(), expected.node(), "node", [](const auto& node) { return node.name(); });
  require_same(graph.output(), expected.output(), "output", [](const auto& output) { return output.name(); });
  require_same_constants(graph, expected);
}

}  // namespace thermorig::model
