// SPDX-License-Identifier: MIT
#include "wire_check.h"

#include <algorithm>
#include <cstddef>
#include <iterator>

#include "refusal.h"

namespace thermorig::model {

namespace {

// Protobuf's encoding: https://protobuf.dev/programming-guides/encoding; the messages: onnx.proto.
enum class Message : unsigned char {
  model,
  graph,
  node,
  attribute,
  tensor,
  value_info,
  type,
  tensor_type,
  shape,
  dimension,
  entry,
  opset,
};

enum class Treatment : unsigned char {
  enter,   // a message: its fields are walked
  count,   // packed whole numbers: a byte may become eight
  refuse,  // nothing that this network has
};

struct Rule {
  Message parent;
  std::uint64_t field;
  Treatment treatment;
  Message child = Message::model;
};

/// Fields without a rule are numbers, text or values, and as large in memory as in the file.
constexpr Rule rules[] = {
    {Message::model, 7, Treatment::enter, Message::graph},
    {Message::model, 8, Treatment::enter, Message::opset},
    {Message::model, 14, Treatment::enter, Message::entry},
    {Message::model, 20, Treatment::refuse},  // training_info
    {Message::model, 25, Treatment::refuse},  // functions
    {Message::graph, 1, Treatment::enter, Message::node},
    {Message::graph, 5, Treatment::enter, Message::tensor},
    {Message::graph, 11, Treatment::enter, Message::value_info},
    {Message::graph, 12, Treatment::enter, Message::value_info},
    {Message::graph, 13, Treatment::enter, Message::value_info},
    {Message::graph, 14, Treatment::refuse},  // quantization_annotation
    {Message::graph, 15, Treatment::refuse},  // sparse_initializer
    {Message::node, 5, Treatment::enter, Message::attribute},
    {Message::attribute, 5, Treatment::enter, Message::tensor},
    {Message::attribute, 6, Treatment::refuse},   // g
    {Message::attribute, 8, Treatment::count},    // ints
    {Message::attribute, 10, Treatment::refuse},  // tensors
    {Message::attribute, 11, Treatment::refuse},  // graphs
    {Message::attribute, 14, Treatment::refuse},  // tp
    {Message::attribute, 15, Treatment::refuse},  // type_protos
    {Message::attribute, 22, Treatment::refuse},  // sparse_tensor
    {Message::attribute, 23, Treatment::refuse},  // sparse_tensors
    {Message::tensor, 1, Treatment::count},       // dims
    {Message::tensor, 5, Treatment::count},       // int32_data
    {Message::tensor, 7, Treatment::count},       // int64_data
    {Message::tensor, 11, Treatment::count},      // uint64_data
    {Message::tensor, 13, Treatment::enter, Message::entry},
    {Message::value_info, 2, Treatment::enter, Message::type},
    {Message::type, 1, Treatment::enter, Message::tensor_type},
    {Message::type, 4, Treatment::refuse},  // sequence_type
    {Message::type, 5, Treatment::refuse},  // map_type
    {Message::type, 8, Treatment::refuse},  // sparse_tensor_type
    {Message::type, 9, Treatment::refuse},  // optional_type
    {Message::tensor_type, 2, Treatment::enter, Message::shape},
    {Message::shape, 1, Treatment::enter, Message::dimension},
};

const Rule* rule_for(Message parent, std::uint64_t field) {
  const auto* found = std::find_if(std::begin(rules), std::end(rules), [&](const Rule& rule) {
    return rule.parent == parent && rule.field == field;
  });
  return found == std::end(rules) ? nullptr : found;
}

/// A model of ours needs about 400 fields, and 3 for each acquisition that it names in about 100 bytes.
constexpr std::size_t fields_always = 2000;
constexpr std::size_t bytes_a_field = 24;

class Walk {
 public:
  explicit Walk(std::span<const std::uint8_t> bytes)
      : rest_(bytes), fields_left_(fields_always + bytes.size() / bytes_a_field) {}

  /// `rest_` is a message of this kind; afterwards it is empty.
  void message(Message kind) {
    while (!rest_.empty()) field(kind);
  }

 private:
  enum WireType : std::uint64_t { varint_type = 0, fixed64_type = 1, bytes_type = 2, fixed32_type = 5 };

  void field(Message parent) {
    const std::uint64_t tag = varint();
    if (tag >> 3U == 0) refuse_damaged();
    spend(1);
    switch (tag & 7U) {
      case varint_type:
        varint();
        return;
      case fixed64_type:
        take(8);
        return;
      case fixed32_type:
        take(4);
        return;
      case bytes_type:
        value(rule_for(parent, tag >> 3U), take(varint()));
        return;
      default:
        refuse_damaged();
    }
  }

  void value(const Rule* rule, std::span<const std::uint8_t> bytes) {
    if (rule == nullptr) return;
    if (rule->treatment == Treatment::refuse)
      throw Refusal(
          "its graph has functions, graphs within the graph, sparse or quantised tensors, which this "
          "network has not");
    if (rule->treatment == Treatment::count) return spend(bytes.size());
    std::swap(rest_, bytes);
    message(rule->child);
    rest_ = bytes;
  }

  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 64; shift += 7) {
      const std::uint8_t byte = take(1).front();
      value |= std::uint64_t{byte & 0x7FU} << shift;
      if (byte < 0x80) return value;
    }
    refuse_damaged();
  }

  std::span<const std::uint8_t> take(std::uint64_t size) {
    if (size > rest_.size())
      throw Refusal("it is no ONNX file, or it has been cut off", "copy or export it again");
    const auto taken = rest_.first(static_cast<std::size_t>(size));
    rest_ = rest_.subspan(taken.size());
    return taken;
  }

  void spend(std::size_t fields) {
    if (fields > fields_left_) throw Refusal("it has far more parts than this network needs");
    fields_left_ -= fields;
  }

  [[noreturn]] static void refuse_damaged() {
    throw Refusal("it is no ONNX file, or a damaged one", "copy or export it again");
  }

  std::span<const std::uint8_t> rest_;
  std::size_t fields_left_;
};

}  // namespace

void check_wire(std::span<const std::uint8_t> bytes) {
  Walk(bytes).message(Message::model);
}

}  // namespace thermorig::model
