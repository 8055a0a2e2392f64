// SPDX-License-Identifier: MIT
#include "edited_file.h"

#include <algorithm>
#include <stdexcept>

namespace thermorig::model {

EditedFile::EditedFile(const Model& model) {
  if (!file_.ParseFromString(to_onnx(model))) throw std::logic_error("cannot parse our own file");
}

int EditedFile::index_of(std::string_view output) const {
  const auto& nodes = file_.graph().node();
  const auto found =
      std::find_if(nodes.begin(), nodes.end(), [&](const auto& node) { return node.output(0) == output; });
  if (found == nodes.end()) throw std::logic_error("no such node: " + std::string(output));
  return static_cast<int>(found - nodes.begin());
}

onnx::NodeProto& EditedFile::node(std::string_view output) {
  return *graph().mutable_node(index_of(output));
}

onnx::TensorProto& EditedFile::tensor(std::string_view name) {
  for (auto& tensor : *graph().mutable_initializer())
    if (tensor.name() == name) return tensor;
  throw std::logic_error("no such tensor: " + std::string(name));
}

onnx::AttributeProto& EditedFile::attribute(std::string_view output, const std::string& name) {
  onnx::NodeProto& changed = node(output);
  for (auto& attribute : *changed.mutable_attribute())
    if (attribute.name() == name) return attribute;
  onnx::AttributeProto& added = *changed.add_attribute();
  added.set_name(name);
  return added;
}

void EditedFile::set(std::string_view output, const std::string& name, std::int64_t value) {
  onnx::AttributeProto& changed = attribute(output, name);
  changed.set_type(onnx::AttributeProto::INT);
  changed.set_i(value);
}

void EditedFile::set(std::string_view output, const std::string& name,
                     const std::vector<std::int64_t>& values) {
  onnx::AttributeProto& changed = attribute(output, name);
  changed.set_type(onnx::AttributeProto::INTS);
  changed.clear_ints();
  for (const std::int64_t value : values) changed.add_ints(value);
}

onnx::NodeProto& EditedFile::insert(std::string_view before, const std::string& operation,
                                    std::initializer_list<std::string> inputs, const std::string& output) {
  const int place = index_of(before);
  onnx::NodeProto& added = *graph().add_node();
  added.set_op_type(operation);
  for (const std::string& input : inputs) added.add_input(input);
  added.add_output(output);
  auto& nodes = *graph().mutable_node();
  for (int i = nodes.size() - 1; i > place; --i) nodes.SwapElements(i, i - 1);
  return nodes[place];
}

void EditedFile::remove_node(std::string_view output) {
  graph().mutable_node()->DeleteSubrange(index_of(output), 1);
}

void EditedFile::bypass(std::string_view output) {
  const std::string source = node(output).input(0), gone(output);
  remove_node(output);
  for (auto& user : *graph().mutable_node())
    for (std::string& input : *user.mutable_input())
      if (input == gone) input = source;
}

void EditedFile::add_integers(const std::string& name, const std::vector<std::int64_t>& values) {
  onnx::TensorProto& tensor = *graph().add_initializer();
  tensor.set_name(name);
  tensor.set_data_type(onnx::TensorProto::INT64);
  tensor.add_dims(static_cast<std::int64_t>(values.size()));
  for (const std::int64_t value : values) tensor.add_int64_data(value);
}

void EditedFile::set_key(const std::string& key, const std::string& value) {
  remove_key(key);
  onnx::StringStringEntryProto& entry = *file_.add_metadata_props();
  entry.set_key(key);
  entry.set_value(value);
}

void EditedFile::remove_key(std::string_view key) {
  auto& entries = *file_.mutable_metadata_props();
  for (int i = entries.size() - 1; i >= 0; --i)
    if (entries[i].key() == key) entries.DeleteSubrange(i, 1);
}

void EditedFile::keep_scaling_alone() {
  auto& entries = *file_.mutable_metadata_props();
  for (int i = entries.size() - 1; i >= 0; --i)
    if (!entries[i].key().starts_with("label_scale") && !entries[i].key().starts_with("temp_"))
      entries.DeleteSubrange(i, 1);
}

}  // namespace thermorig::model
