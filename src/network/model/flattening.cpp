// SPDX-License-Identifier: MIT
#include "flattening.h"

#include "attributes.h"
#include "graph_steps.h"
#include "refusal.h"
#include "tensor_values.h"

namespace thermorig::model {

namespace {

using Integers = std::vector<std::int64_t>;

[[noreturn]] void refuse_reshape() {
  throw Refusal("its graph is another network: it does not reshape to (N, features)");
}

Integers constant_integers(const Origin& origin) {
  if (origin.constant == nullptr) refuse_graph("a size to reshape to", origin, "a constant");
  return integers_of(*origin.constant);
}

/// From opset 13 on the axes are an input.
Origin unsqueezed(const Graph& graph, const Origin& origin) {
  const onnx::NodeProto& node = node_of(origin, "Unsqueeze", "a size to reshape to");
  Integers axes = Attributes(node, {"axes"}).integers("axes", {});
  if (node.input_size() > 1) axes = constant_integers(graph.input_of(node, 1));
  if (axes != Integers{0}) refuse_reshape();
  return graph.input_of(node, 0);
}

/// Gather(Shape(x), 0), x being the maps or an input of the graph: all have the windows first.
void require_window_count(const Graph& graph, const Origin& origin, const Origin& maps) {
  const onnx::NodeProto& gather = node_of(origin, "Gather", "the number of windows");
  Attributes(gather, {"axis"}).expect("axis", 0, 0);
  if (constant_integers(graph.input_of(gather, 1)) != Integers{0}) refuse_reshape();
  const Origin whose = before(graph, graph.input_of(gather, 0), "Shape", "the number of windows");
  if (whose != maps && whose.input == nullptr) refuse_reshape();
}

/// `x.view(x.size(0), -1)`: Concat(Unsqueeze(windows), [-1]). Returns its last number.
std::int64_t looked_up_features(const Graph& graph, const onnx::NodeProto& joined, const Origin& maps) {
  Attributes(joined, {"axis"}).expect("axis", 0, 1);
  if (joined.input_size() != 2) refuse_reshape();
  require_window_count(graph, unsqueezed(graph, graph.input_of(joined, 0)), maps);
  Origin rest = graph.input_of(joined, 1);
  if (rest.is("Unsqueeze")) rest = unsqueezed(graph, rest);
  const Integers features = constant_integers(rest);
  if (features.size() != 1) refuse_reshape();
  return features[0];
}

}  // namespace

Origin Flattening::before(const Graph& graph, const Origin& features, std::string_view place) {
  if (!features.is("Flatten") && !features.is("Reshape")) refuse_graph(place, features, "Flatten or Reshape");
  const Origin maps = graph.input_of(*features.node, 0);
  if (features.is("Flatten"))
    Attributes(*features.node, {"axis"}).expect("axis", 1, 1);
  else
    read_reshape(graph, *features.node, maps);
  return maps;
}

/// In a Reshape's sizes 0 is what was there before (unless `allowzero` says otherwise) and -1 what is left.
void Flattening::read_reshape(const Graph& graph, const onnx::NodeProto& reshape, const Origin& maps) {
  const bool zero_is_zero = Attributes(reshape, {"allowzero"}).integer("allowzero", 0) != 0;
  const Origin target = graph.input_of(reshape, 1);
  if (target.constant == nullptr)
    return keep(0, looked_up_features(graph, node_of(target, "Concat", "the shape to reshape to"), maps));
  const Integers sizes = integers_of(*target.constant);
  if (sizes.size() != 2 || (sizes[0] == 0 && zero_is_zero)) refuse_reshape();
  keep(sizes[0], sizes[1]);
}

void Flattening::keep(std::int64_t windows, std::int64_t features) {
  const auto contradicts = [](const auto& known, std::int64_t size) { return known && *known != size; };
  const bool features_said = features != -1;
  if (windows < -1 || features < -1 || features == 0 || (windows == -1 && !features_said)) refuse_reshape();
  if (windows > 0 && contradicts(windows_, windows)) refuse_reshape();
  if (features_said && contradicts(features_, features)) refuse_reshape();
  if (windows > 0) windows_ = windows;
  if (features_said) features_ = features;
}

void Flattening::check(const network::Shape& shape, std::int64_t batch) const {
  if (features_ && *features_ != shape.features()) refuse_reshape();
  if (windows_ && *windows_ != batch)
    throw Refusal("its graph reshapes for another number of windows than its input has");
}

}  // namespace thermorig::model
