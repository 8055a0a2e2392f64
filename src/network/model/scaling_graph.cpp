// SPDX-License-Identifier: MIT
#include "scaling_graph.h"

#include <fmt/format.h>

#include <map>
#include <string>

#include "names.h"

namespace thermorig::model {

namespace {

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

template <class Parts, class NameOf>
bool has_all(const Parts& expected, const Parts& found, NameOf name_of) {
  std::map<std::string, std::string> bytes;
  for (const auto& part : found) bytes[name_of(part)] = part.SerializeAsString();
  for (const auto& part : expected) {
    const auto same = bytes.find(name_of(part));
    if (same == bytes.end() || same->second != part.SerializeAsString()) return false;
  }
  return true;
}

}  // namespace

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

std::optional<int> reduction_of_window_scaling(const onnx::GraphProto& graph) {
  for (int reduction = network::min_reduction; reduction <= network::max_reduction; ++reduction) {
    onnx::GraphProto expected;
    GraphBuilder builder(expected);
    add_window_scaling(builder, {.reduction = reduction});
    const auto output = [](const onnx::NodeProto& node) {
      return node.output_size() > 0 ? node.output(0) : std::string();
    };
    if (has_all(expected.node(), graph.node(), output) &&
        has_all(expected.initializer(), graph.initializer(),
                [](const onnx::TensorProto& tensor) { return tensor.name(); }))
      return reduction;
  }
  return std::nullopt;
}

}  // namespace thermorig::model
