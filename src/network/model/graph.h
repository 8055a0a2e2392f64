// SPDX-License-Identifier: MIT
#pragma once

#include <onnx/onnx_pb.h>

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace thermorig::model {

/// Where a value of the graph comes from: just one of the three is set.
struct Origin {
  const onnx::NodeProto* node = nullptr;        // its first output
  const onnx::TensorProto* constant = nullptr;  // an initialiser, or the value of a Constant node
  const onnx::ValueInfoProto* input = nullptr;  // of the graph
  bool operator==(const Origin&) const = default;

  /// Is it the first output of such a node of the standard operators?
  bool is(std::string_view operation) const;
};

/// For sentences: "Relu", "a constant", "the input 'frames'".
std::string description_of(const Origin& origin);

/// A graph whose values are looked up by name. Identity nodes are seen through.
class Graph {
 public:
  /// Throws Refusal where a name is given twice or a node uses what no earlier one makes: so there is no
  /// circle either.
  explicit Graph(const onnx::GraphProto& graph);

  /// The `index`-th input of a node. Throws Refusal if it has none.
  Origin input_of(const onnx::NodeProto& node, int index) const;

  /// The output of the graph with this name; nothing set if it has none.
  Origin output(std::string_view name) const;

  /// The input of the graph with this name; nothing set if it has none.
  Origin input_named(std::string_view name) const;

  /// What has to be fed in: without the inputs that are initialisers as well, as older files have them.
  const std::vector<const onnx::ValueInfoProto*>& inputs() const { return inputs_; }
  /// Throws Refusal unless all outputs have one of these names.
  void check_outputs(const std::vector<std::string_view>& names) const;

 private:
  void add(const std::string& name, const Origin& origin);
  void add(const onnx::NodeProto& node);

  const onnx::GraphProto& graph_;
  std::map<std::string_view, Origin> origins_;  // names lie in `graph_`; nothing set: a further output
  std::vector<const onnx::ValueInfoProto*> inputs_;
};

}  // namespace thermorig::model
