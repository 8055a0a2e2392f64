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

}  // namespace thermorig::model
