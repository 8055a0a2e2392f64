// SPDX-License-Identifier: MIT
#include "attributes.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "refusal.h"
#include "text.h"

namespace thermorig::model {

Attributes::Attributes(const onnx::NodeProto& node, std::initializer_list<std::string_view> known)
    : node_(node) {
  std::set<std::string_view> seen;
  for (const auto& attribute : node.attribute()) {
    const bool expected = std::find(known.begin(), known.end(), attribute.name()) != known.end();
    if (!expected || !seen.insert(attribute.name()).second) refuse(attribute.name());
  }
}

void Attributes::refuse(std::string_view name) const {
  throw Refusal(fmt::format("its graph is another network: the {} of a {} is not this network's",
                            in_quotes(name), plain_text(node_.op_type(), 40)));
}

const onnx::AttributeProto* Attributes::find(std::string_view name,
                                             onnx::AttributeProto::AttributeType type) const {
  const auto& all = node_.attribute();
  const auto found = std::find_if(all.begin(), all.end(), [&](const auto& a) { return a.name() == name; });
  if (found == all.end()) return nullptr;
  if (found->type() != type || !found->ref_attr_name().empty()) refuse(name);
  return &*found;
}

std::int64_t Attributes::integer(std::string_view name, std::int64_t otherwise) const {
  const auto* attribute = find(name, onnx::AttributeProto::INT);
  return attribute == nullptr ? otherwise : attribute->i();
}

float Attributes::number(std::string_view name, float otherwise) const {
  const auto* attribute = find(name, onnx::AttributeProto::FLOAT);
  return attribute == nullptr ? otherwise : attribute->f();
}

std::vector<std::int64_t> Attributes::integers(std::string_view name,
                                               std::vector<std::int64_t> otherwise) const {
  const auto* attribute = find(name, onnx::AttributeProto::INTS);
  if (attribute == nullptr) return otherwise;
  return {attribute->ints().begin(), attribute->ints().end()};
}

const onnx::TensorProto& Attributes::tensor(std::string_view name) const {
  const auto* attribute = find(name, onnx::AttributeProto::TENSOR);
  if (attribute == nullptr) refuse(name);
  return attribute->t();
}

void Attributes::expect(std::string_view name, std::int64_t value, std::int64_t otherwise) const {
  if (integer(name, otherwise) != value) refuse(name);
}

void Attributes::expect(std::string_view name, const std::vector<std::int64_t>& value,
                        std::vector<std::int64_t> otherwise) const {
  if (integers(name, std::move(otherwise)) != value) refuse(name);
}

void Attributes::expect_text(std::string_view name, std::string_view value) const {
  const auto* attribute = find(name, onnx::AttributeProto::STRING);
  if (attribute != nullptr && attribute->s() != value) refuse(name);
}

void Attributes::expect_number(std::string_view name, float value, float otherwise) const {
  if (number(name, otherwise) != value) refuse(name);
}

}  // namespace thermorig::model
