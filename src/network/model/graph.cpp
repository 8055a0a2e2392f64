// SPDX-License-Identifier: MIT
#include "graph.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "attributes.h"
#include "refusal.h"
#include "text.h"

namespace thermorig::model {

bool Origin::is(std::string_view operation) const {
  return node != nullptr && node->op_type() == operation &&
         (node->domain().empty() || node->domain() == "ai.onnx");
}

std::string description_of(const Origin& origin) {
  if (origin.node != nullptr) return plain_text(origin.node->op_type(), 40);
  if (origin.constant != nullptr) return "a constant";
  return origin.input != nullptr ? "the input " + in_quotes(origin.input->name()) : "nowhere";
}

Graph::Graph(const onnx::GraphProto& graph) : graph_(graph) {
  for (const auto& tensor : graph.initializer()) add(tensor.name(), {.constant = &tensor});
  for (const auto& input : graph.input()) {
    const auto known = origins_.find(input.name());
    if (known != origins_.end() && known->second.constant != nullptr) continue;
    add(input.name(), {.input = &input});
    inputs_.push_back(&input);
  }
  for (const auto& node : graph.node()) add(node);
}

void Graph::add(const std::string& name, const Origin& origin) {
  if (!origins_.emplace(name, origin).second)
    throw Refusal(fmt::format("its graph has {} twice", in_quotes(name)));
}

void Graph::add(const onnx::NodeProto& node) {
  for (const std::string& name : node.input())
    if (!name.empty() && !origins_.contains(name))
      throw Refusal(fmt::format("its graph uses {}, which nothing before makes", in_quotes(name)));
  Origin origin{.node = &node};
  if (origin.is("Identity")) origin = input_of(node, 0);
  if (origin.is("Constant")) origin = {.constant = &Attributes(node, {"value"}).tensor("value")};
  for (int i = 0; i < node.output_size(); ++i)
    if (i == 0 || !node.output(i).empty()) add(node.output(i), i == 0 ? origin : Origin{});
}

Origin Graph::input_of(const onnx::NodeProto& node, int index) const {
  if (index >= node.input_size() || node.input(index).empty())
    throw Refusal(fmt::format("a {} of its graph has too few inputs", description_of({.node = &node})));
  return origins_.at(node.input(index));
}

Origin Graph::input_named(std::string_view name) const {
  for (const onnx::ValueInfoProto* input : inputs_)
    if (input->name() == name) return {.input = input};
  return {};
}

Origin Graph::output(std::string_view name) const {
  const auto& outputs = graph_.output();
  const bool listed =
      std::any_of(outputs.begin(), outputs.end(), [&](const auto& output) { return output.name() == name; });
  if (!listed) return {};
  const auto found = origins_.find(name);
  if (found == origins_.end() || found->second == Origin{})
    throw Refusal(fmt::format("its graph lacks what makes the output {}", in_quotes(name)));
  return found->second;
}

void Graph::check_outputs(const std::vector<std::string_view>& names) const {
  for (const auto& output : graph_.output())
    if (std::find(names.begin(), names.end(), output.name()) == names.end())
      throw Refusal(
          fmt::format("its graph has the output {}, which this network has not", in_quotes(output.name())),
          fmt::format("name the outputs {} when exporting", fmt::join(names, ", ")));
}

}  // namespace thermorig::model
