// SPDX-License-Identifier: MIT
#pragma once

#include <onnx/onnx_pb.h>

#include <map>
#include <string>

#include "thermorig/network/shape.h"

namespace thermorig::model {

/// A tensor of the file that holds one of the network's.
struct TensorSource {
  const onnx::TensorProto* tensor = nullptr;
  bool transposed = false;  // (in, out) instead of PyTorch's (out, in)
};

/// What a graph says that computes this network.
struct NetworkGraph {
  network::Shape shape;  // crop_left is not in a graph
  float speed_scale =
      0.0F;  // above 0: frames are scaled in the graph, and speeds are degrees a period over it
  std::map<std::string, TensorSource>
      tensors;  // by the names of network::tensors_of, also where the file's differ
};

/// Follows the graph from its outputs to its inputs, node by node. Throws Refusal, saying where it differs,
/// unless it computes just the paper's network (section III, Fig. 2, equation 2). Points into `graph`.
NetworkGraph network_of(const onnx::GraphProto& graph);

}  // namespace thermorig::model
