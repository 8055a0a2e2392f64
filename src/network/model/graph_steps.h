// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string_view>

#include "graph.h"

namespace thermorig::model {

// Steps from a value of a graph towards the inputs. Each throws Refusal, naming `place`, where the graph is
// another network's.

[[noreturn]] void refuse_graph(std::string_view place, const Origin& found, std::string_view expected);

/// The node that makes the value, which must be of this operation.
const onnx::NodeProto& node_of(const Origin& origin, std::string_view operation, std::string_view place);

/// What goes into the operation, which has one input and no attributes.
Origin before(const Graph& graph, const Origin& origin, std::string_view operation, std::string_view place);

/// What goes into a node of two inputs and no attributes.
std::array<Origin, 2> operands_of(const Graph& graph, const onnx::NodeProto& node);

}  // namespace thermorig::model
