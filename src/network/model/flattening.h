// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "graph.h"
#include "thermorig/network/shape.h"

namespace thermorig::model {

/// How a graph makes the maps of Conv2 a row of features: by Flatten, or by Reshape to sizes that stand in
/// the file or are looked up. Both heads may do it on their own.
class Flattening {
 public:
  /// Returns the maps. Throws Refusal for anything else.
  Origin before(const Graph& graph, const Origin& features, std::string_view place);

  /// Throws Refusal unless the sizes met so far are this network's. `batch`: windows at once, 0: any number.
  void check(const network::Shape& shape, std::int64_t batch) const;

 private:
  void read_reshape(const Graph& graph, const onnx::NodeProto& reshape, const Origin& maps);
  void keep(std::int64_t windows, std::int64_t features);

  std::optional<std::int64_t> windows_, features_;  // as a Reshape says them
};

}  // namespace thermorig::model
