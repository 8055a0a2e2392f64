// SPDX-License-Identifier: MIT
#pragma once

#include <onnx/onnx_pb.h>

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "sample_models.h"

namespace thermorig::model {

/// A model file taken apart, changed, and put together again.
class EditedFile {
 public:
  explicit EditedFile(const Model& model = sample_model({.frames = 2, .reduction = 3}));

  onnx::ModelProto& file() { return file_; }
  onnx::GraphProto& graph() { return *file_.mutable_graph(); }
  std::string bytes() const { return file_.SerializeAsString(); }

  onnx::NodeProto& node(std::string_view output);
  onnx::TensorProto& tensor(std::string_view name);
  onnx::AttributeProto& attribute(std::string_view output, const std::string& name);
  void set(std::string_view output, const std::string& name, std::int64_t value);
  void set(std::string_view output, const std::string& name, const std::vector<std::int64_t>& values);

  /// A node before the one that makes `before`.
  onnx::NodeProto& insert(std::string_view before, const std::string& operation,
                          std::initializer_list<std::string> inputs, const std::string& output);
  void remove_node(std::string_view output);
  /// Takes `output` out of the graph's way: who used it uses what it was made from.
  void bypass(std::string_view output);

  void add_integers(const std::string& name, const std::vector<std::int64_t>& values);
  void set_key(const std::string& key, const std::string& value);
  void remove_key(std::string_view key);
  /// Only the scaling stays, as in a file of somebody else.
  void keep_scaling_alone();

 private:
  int index_of(std::string_view output) const;

  onnx::ModelProto file_;
};

}  // namespace thermorig::model
