// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <string>

#include "graph.h"
#include "network_graph.h"

namespace thermorig::model {

/// Reads the layers of a graph from their outputs to their inputs and notes where their weights are. Each
/// throws Refusal for a layer that does something else than this network's.
class Layers {
 public:
  explicit Layers(const Graph& graph) : graph_(graph) {}

  Origin convolution(const std::string& layer, const Origin& output, int& padding);
  Origin pooling(const Origin& output) const;
  /// Gemm, or MatMul and Add.
  Origin linear(const std::string& layer, const Origin& output);

  const std::map<std::string, TensorSource>& tensors() const { return tensors_; }

 private:
  Origin matrix_product(const std::string& layer, const Origin& output);
  void keep(const std::string& name, const Origin& origin, bool transposed = false);
  void keep_matrix(const std::string& name, const Origin& origin, bool transposed);

  const Graph& graph_;
  std::map<std::string, TensorSource> tensors_;
};

}  // namespace thermorig::model
