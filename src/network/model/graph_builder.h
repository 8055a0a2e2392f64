// SPDX-License-Identifier: MIT
#pragma once

#include <onnx/onnx_pb.h>

#include <bit>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "thermorig/network/shape.h"

namespace thermorig::model {

// The values of a tensor are stored as they lie in memory; ONNX asks for little endian.
static_assert(std::endian::native == std::endian::little);

using Names = std::initializer_list<std::string_view>;

/// Builds the graph; each `add` appends, so the order of the calls is the order of the file.
class GraphBuilder {
 public:
  explicit GraphBuilder(onnx::GraphProto& graph) : graph_(graph) {}

  onnx::NodeProto& add(const char* operation, Names inputs, std::string_view output) {
    onnx::NodeProto& node = *graph_.add_node();
    for (const std::string_view input : inputs) node.add_input(std::string(input));
    node.add_output(std::string(output));
    node.set_name(std::string(output));
    node.set_op_type(operation);
    return node;
  }

  void add_convolution(std::string_view layer, std::string_view input, int padding) {
    const std::string name(layer);
    onnx::NodeProto& node = add("Conv", {input, name + ".weight", name + ".bias"}, name);
    set(node, "kernel_shape", {network::kernel_size, network::kernel_size});
    set(node, "pads", {padding, padding, padding, padding});
    set(node, "strides", {1, 1});
  }

  void add_pooling(std::string_view input, std::string_view output) {
    onnx::NodeProto& node = add("MaxPool", {input}, output);
    set(node, "kernel_shape", {2, 2});
    set(node, "pads", {0, 0, 0, 0});
    set(node, "strides", {2, 2});
  }

  /// y = x W^T + b, as PyTorch's Linear. `output` is the layer's own name where nothing else is said.
  void add_linear(std::string_view layer, std::string_view input, std::string_view output = "") {
    const std::string name(layer);
    onnx::NodeProto& node =
        add("Gemm", {input, name + ".weight", name + ".bias"}, output.empty() ? layer : output);
    set(node, "transB", 1);
  }

  void add_integers(std::string_view name, std::initializer_list<std::int64_t> values) {
    onnx::TensorProto& tensor = *graph_.add_initializer();
    tensor.add_dims(static_cast<std::int64_t>(values.size()));
    tensor.set_data_type(onnx::TensorProto::INT64);
    tensor.set_name(std::string(name));
    tensor.set_raw_data(values.begin(), values.size() * sizeof(std::int64_t));
  }

  void add_tensor(std::string_view name, const std::vector<int>& dimensions, std::span<const float> values) {
    onnx::TensorProto& tensor = *graph_.add_initializer();
    for (const int dimension : dimensions) tensor.add_dims(dimension);
    tensor.set_data_type(onnx::TensorProto::FLOAT);
    tensor.set_name(std::string(name));
    tensor.set_raw_data(values.data(), values.size_bytes());
  }

  static void set(onnx::NodeProto& node, const char* name, std::initializer_list<int> values) {
    onnx::AttributeProto& attribute = *node.add_attribute();
    attribute.set_name(name);
    attribute.set_type(onnx::AttributeProto::INTS);
    for (const int value : values) attribute.add_ints(value);
  }

  static void set(onnx::NodeProto& node, const char* name, int value) {
    onnx::AttributeProto& attribute = *node.add_attribute();
    attribute.set_name(name);
    attribute.set_type(onnx::AttributeProto::INT);
    attribute.set_i(value);
  }

 private:
  onnx::GraphProto& graph_;
};

}  // namespace thermorig::model
