// SPDX-License-Identifier: MIT
#include "layers.h"

#include <fmt/format.h>

#include "attributes.h"
#include "graph_steps.h"
#include "refusal.h"

namespace thermorig::model {

void Layers::keep(const std::string& name, const Origin& origin, bool transposed) {
  if (origin.constant == nullptr)
    throw Refusal(fmt::format("{} is not in the file: it comes from {}", name, description_of(origin)));
  tensors_[name] = {origin.constant, transposed};
}

/// A weight as it is, or behind a Transpose.
void Layers::keep_matrix(const std::string& name, const Origin& origin, bool transposed) {
  if (!origin.is("Transpose")) return keep(name, origin, transposed);
  Attributes(*origin.node, {"perm"}).expect("perm", {1, 0}, {1, 0});
  keep(name, graph_.input_of(*origin.node, 0), !transposed);
}

Origin Layers::convolution(const std::string& layer, const Origin& output, int& padding) {
  const onnx::NodeProto& found = node_of(output, "Conv", "the value after " + layer);
  const Attributes attributes(found, {"kernel_shape", "pads", "strides", "dilations", "group", "auto_pad"});
  attributes.expect("kernel_shape", {network::kernel_size, network::kernel_size}, {5, 5});
  attributes.expect("strides", {1, 1}, {1, 1});
  attributes.expect("dilations", {1, 1}, {1, 1});
  attributes.expect("group", 1, 1);
  attributes.expect_text("auto_pad", "NOTSET");
  const auto pads = attributes.integers("pads", {0, 0, 0, 0});
  if (pads.empty() || pads[0] < 0 || pads[0] > 2 || pads != std::vector<std::int64_t>(4, pads[0]))
    throw Refusal(fmt::format("{} is not padded by 0, 1 or 2 on all sides", layer));
  padding = static_cast<int>(pads[0]);
  keep(layer + ".weight", graph_.input_of(found, 1));
  keep(layer + ".bias", graph_.input_of(found, 2));
  return graph_.input_of(found, 0);
}

Origin Layers::pooling(const Origin& output) const {
  const onnx::NodeProto& found = node_of(output, "MaxPool", "the input of conv2");
  const Attributes attributes(
      found, {"kernel_shape", "pads", "strides", "dilations", "ceil_mode", "storage_order", "auto_pad"});
  attributes.expect("kernel_shape", {2, 2}, {});
  attributes.expect("strides", {2, 2}, {1, 1});
  attributes.expect("pads", {0, 0, 0, 0}, {0, 0, 0, 0});
  attributes.expect("dilations", {1, 1}, {1, 1});
  attributes.expect("ceil_mode", 0, 0);
  attributes.expect("storage_order", 0, 0);
  attributes.expect_text("auto_pad", "NOTSET");
  return graph_.input_of(found, 0);
}

Origin Layers::linear(const std::string& layer, const Origin& output) {
  if (output.is("Add")) return matrix_product(layer, output);
  const onnx::NodeProto& found = node_of(output, "Gemm", "the value after " + layer);
  const Attributes attributes(found, {"alpha", "beta", "transA", "transB"});
  attributes.expect_number("alpha", 1.0F, 1.0F);
  attributes.expect_number("beta", 1.0F, 1.0F);
  attributes.expect("transA", 0, 0);
  const bool as_pytorch = attributes.integer("transB", 0) != 0;
  keep_matrix(layer + ".weight", graph_.input_of(found, 1), !as_pytorch);
  keep(layer + ".bias", graph_.input_of(found, 2));
  return graph_.input_of(found, 0);
}

/// Add(MatMul(x, W^T), b), in either order.
Origin Layers::matrix_product(const std::string& layer, const Origin& output) {
  auto [product, bias] = operands_of(graph_, *output.node);
  if (!product.is("MatMul")) std::swap(product, bias);
  const auto [input, weight] = operands_of(graph_, node_of(product, "MatMul", "the value after " + layer));
  keep_matrix(layer + ".weight", weight, true);
  keep(layer + ".bias", bias);
  return input;
}

}  // namespace thermorig::model
