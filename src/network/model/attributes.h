// SPDX-License-Identifier: MIT
#pragma once

#include <onnx/onnx_pb.h>

#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <vector>

namespace thermorig::model {

/// The attributes of a node. Every member throws Refusal for one of another type than it asks for.
class Attributes {
 public:
  /// Refuses attributes that are not among `known`, and any that comes twice.
  Attributes(const onnx::NodeProto& node, std::initializer_list<std::string_view> known);

  std::int64_t integer(std::string_view name, std::int64_t otherwise) const;
  float number(std::string_view name, float otherwise) const;
  std::vector<std::int64_t> integers(std::string_view name, std::vector<std::int64_t> otherwise) const;
  const onnx::TensorProto& tensor(std::string_view name) const;

  /// Each throws Refusal unless the attribute has this value (or is not there, where `otherwise` is it).
  void expect(std::string_view name, std::int64_t value, std::int64_t otherwise) const;
  void expect(std::string_view name, const std::vector<std::int64_t>& value,
              std::vector<std::int64_t> otherwise) const;
  void expect_text(std::string_view name, std::string_view value) const;
  void expect_number(std::string_view name, float value, float otherwise) const;

 private:
  const onnx::AttributeProto* find(std::string_view name, onnx::AttributeProto::AttributeType type) const;
  [[noreturn]] void refuse(std::string_view name) const;

  const onnx::NodeProto& node_;
};

}  // namespace thermorig::model
