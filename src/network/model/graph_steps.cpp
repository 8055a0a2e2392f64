// SPDX-License-Identifier: MIT
#include "graph_steps.h"

#include <fmt/format.h>

#include "attributes.h"
#include "refusal.h"

namespace thermorig::model {

void refuse_graph(std::string_view place, const Origin& found, std::string_view expected) {
  throw Refusal(fmt::format("its graph is another network: {} comes from {}, not from {}", place,
                            description_of(found), expected));
}

const onnx::NodeProto& node_of(const Origin& origin, std::string_view operation, std::string_view place) {
  if (!origin.is(operation)) refuse_graph(place, origin, operation);
  return *origin.node;
}

Origin before(const Graph& graph, const Origin& origin, std::string_view operation, std::string_view place) {
  const onnx::NodeProto& node = node_of(origin, operation, place);
  const Attributes none(node, {});
  return graph.input_of(node, 0);
}

std::array<Origin, 2> operands_of(const Graph& graph, const onnx::NodeProto& node) {
  const Attributes none(node, {});
  return {graph.input_of(node, 0), graph.input_of(node, 1)};
}

}  // namespace thermorig::model
