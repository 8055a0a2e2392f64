// SPDX-License-Identifier: MIT
#include "network_graph.h"

#include <fmt/format.h>

#include <array>
#include <optional>

#include "attributes.h"
#include "graph.h"
#include "names.h"
#include "refusal.h"
#include "tensor_values.h"
#include "text.h"

namespace thermorig::model {

namespace {

constexpr const char* names_advice =
    "export with input_names=['frames', 'gyro'] and output_names=['fusion', 'thermal', 'gain'], thermal-only "
    "with ['frames'] and ['thermal']";

[[noreturn]] void refuse_graph(std::string_view place, const Origin& found, std::string_view expected) {
  throw Refusal(fmt::format("its graph is another network: {} comes from {}, not from {}", place,
                            description_of(found), expected));
}

/// The fusion's three operands (paper equation 2).
struct Operands {
  Origin gain, thermal, gyro;
};

class Reading {
 public:
  explicit Reading(const onnx::GraphProto& file) : graph_(file) {}

  NetworkGraph network() {
    graph_.check_outputs({value::fusion, value::thermal, value::gain});
    result_.shape.fusion = graph_.output(value::fusion) != Origin{};
    const Origin maps = result_.shape.fusion ? fusion() : thermal_only();
    const Origin frames = backbone(maps);
    read_frames(frames);
    check_inputs();
    if (flat_size_ != -1 && flat_size_ != result_.shape.features())
      throw Refusal("its graph is another network: it reshapes to another number of features");
    return std::move(result_);
  }

 private:
  // ------------------------------------------------------------------ steps towards the inputs
  const onnx::NodeProto& node(const Origin& origin, std::string_view operation,
                              std::string_view place) const {
    if (!origin.is(operation)) refuse_graph(place, origin, operation);
    return *origin.node;
  }

  Origin before(const Origin& origin, std::string_view operation, std::string_view place) const {
    const onnx::NodeProto& found = node(origin, operation, place);
    const Attributes none(found, {});
    return graph_.input_of(found, 0);
  }

  std::array<Origin, 2> operands(const onnx::NodeProto& found) const {
    const Attributes none(found, {});
    return {graph_.input_of(found, 0), graph_.input_of(found, 1)};
  }

  // ------------------------------------------------------------------ layers
  void keep(const std::string& name, const Origin& origin, bool transposed = false) {
    if (origin.constant == nullptr)
      throw Refusal(fmt::format("{} is not in the file: it comes from {}", name, description_of(origin)));
    result_.tensors[name] = {origin.constant, transposed};
  }

  Origin convolution(const std::string& layer, const Origin& origin, int& padding) {
    const onnx::NodeProto& found = node(origin, "Conv", "the value after " + layer);
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

  Origin pooling(const Origin& origin) const {
    const onnx::NodeProto& found = node(origin, "MaxPool", "the input of conv2");
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

  /// A weight as it is, or behind a Transpose.
  void keep_matrix(const std::string& name, const Origin& origin, bool transposed) {
    if (!origin.is("Transpose")) return keep(name, origin, transposed);
    Attributes(*origin.node, {"perm"}).expect("perm", {1, 0}, {1, 0});
    keep(name, graph_.input_of(*origin.node, 0), !transposed);
  }

  Origin linear(const std::string& layer, const Origin& origin) {
    if (origin.is("Add")) return matrix_product(layer, origin);
    const onnx::NodeProto& found = node(origin, "Gemm", "the value after " + layer);
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
  Origin matrix_product(const std::string& layer, const Origin& origin) {
    auto [product, bias] = operands(*origin.node);
    if (!product.is("MatMul")) std::swap(product, bias);
    const auto [input, weight] = operands(node(product, "MatMul", "the value after " + layer));
    keep_matrix(layer + ".weight", weight, true);
    keep(layer + ".bias", bias);
    return input;
  }

  // ------------------------------------------------------------------ parts of the network
  /// Returns the input of the network. Relu and MaxPool change places without changing a value.
  Origin backbone(const Origin& maps) {
    const Origin pooled =
        convolution("conv2", before(maps, "Relu", "the value to flatten"), result_.shape.padding2);
    const Origin filtered = pooled.is("Relu") ? pooling(before(pooled, "Relu", "the input of conv2"))
                                              : before(pooling(pooled), "Relu", "the input of the pooling");
    return convolution("conv1", filtered, result_.shape.padding1);
  }

  Origin speed_head(const Origin& thermal) {
    const Origin hidden2 = before(linear("speed3", thermal), "Relu", "the input of speed3");
    const Origin hidden1 = before(linear("speed2", hidden2), "Relu", "the input of speed2");
    return flattened(linear("speed1", hidden1), "the input of speed1");
  }

  Origin gain_head(const Origin& gain) {
    const Origin hidden =
        before(linear("gain2", before(gain, "Sigmoid", "the gain")), "Relu", "the input of gain2");
    return flattened(linear("gain1", hidden), "the input of gain1");
  }

  Origin thermal_only() {
    const Origin thermal = graph_.output(value::thermal);
    if (thermal == Origin{})
      throw Refusal("its graph has neither output 'fusion' nor 'thermal'", names_advice);
    if (graph_.output(value::gain) != Origin{})
      throw Refusal("its graph has an output 'gain', but no 'fusion'", names_advice);
    return speed_head(thermal);
  }

  /// Returns what both heads begin with.
  Origin fusion() {
    const Operands found = fusion_operands(node(graph_.output(value::fusion), "Add", "the fusion"));
    check_output(value::thermal, found.thermal);
    check_output(value::gain, found.gain);
    gyro_ = found.gyro;
    const Origin maps = speed_head(found.thermal);
    if (gain_head(found.gain) != maps)
      throw Refusal("its graph is another network: its two heads begin with different values");
    return maps;
  }

  void check_output(std::string_view name, const Origin& expected) const {
    const Origin found = graph_.output(name);
    if (found != Origin{} && found != expected)
      throw Refusal(
          fmt::format("its graph is another network: the output '{}' is not what the fusion uses", name));
  }

  Operands fusion_operands(const onnx::NodeProto& sum) const {
    const auto [first, second] = operands(sum);
    for (const auto& [a, b] : {std::pair(first, second), std::pair(second, first)}) {
      if (const auto found = weighted_sum(a, b)) return *found;
      if (const auto found = correction(a, b)) return *found;
    }
    throw Refusal("its graph is another network: the fusion is not gain * thermal + (1 - gain) * gyro");
  }

  /// gain * thermal + (1 - gain) * gyro.
  std::optional<Operands> weighted_sum(const Origin& thermal_share, const Origin& gyro_share) const {
    if (!thermal_share.is("Mul") || !gyro_share.is("Mul")) return std::nullopt;
    auto [gain, thermal] = operands(*thermal_share.node);
    if (!gain.is("Sigmoid")) std::swap(gain, thermal);
    auto [rest, gyro] = operands(*gyro_share.node);
    if (!rest.is("Sub")) std::swap(rest, gyro);
    if (!gain.is("Sigmoid") || !rest.is("Sub")) return std::nullopt;
    const auto [one, subtracted] = operands(*rest.node);
    if (one.constant == nullptr || !is_one(*one.constant) || subtracted != gain) return std::nullopt;
    return Operands{gain, thermal, gyro};
  }

  /// gyro + gain * (thermal - gyro): the same number, as torch.lerp writes it.
  std::optional<Operands> correction(const Origin& gyro, const Origin& change) const {
    if (!change.is("Mul")) return std::nullopt;
    auto [gain, difference] = operands(*change.node);
    if (!gain.is("Sigmoid")) std::swap(gain, difference);
    if (!gain.is("Sigmoid") || !difference.is("Sub")) return std::nullopt;
    const auto [thermal, subtracted] = operands(*difference.node);
    if (subtracted != gyro) return std::nullopt;
    return Operands{gain, thermal, gyro};
  }

  // ------------------------------------------------------------------ flattening
  Origin flattened(const Origin& origin, std::string_view place) {
    if (!origin.is("Flatten") && !origin.is("Reshape")) refuse_graph(place, origin, "Flatten or Reshape");
    const Origin maps = graph_.input_of(*origin.node, 0);
    if (origin.is("Flatten"))
      Attributes(*origin.node, {"axis"}).expect("axis", 1, 1);
    else
      read_reshape(*origin.node, maps);
    return maps;
  }

  /// To (as many as there are windows, features): the first by number, by 0 (as it is), by -1 (what is left)
  /// or taken from another value's shape.
  void read_reshape(const onnx::NodeProto& reshape, const Origin& maps) {
    const Attributes attributes(reshape, {"allowzero"});
    const Origin target = graph_.input_of(reshape, 1);
    std::vector<std::int64_t> sizes;
    if (target.constant != nullptr)
      sizes = integers_of(*target.constant);
    else
      sizes = {0, computed_target(node(target, "Concat", "the shape to reshape to"), maps)};
    const bool zero_is_zero = target.constant != nullptr && attributes.integer("allowzero", 0) != 0;
    const bool flat = sizes.size() == 2 && sizes[0] >= -1 && !(sizes[0] == 0 && zero_is_zero) &&
                      (sizes[1] > 0 || (sizes[1] == -1 && sizes[0] != -1)) &&
                      (flat_size_ == -1 || sizes[1] == -1 || sizes[1] == flat_size_);
    if (!flat) throw Refusal("its graph is another network: it does not reshape to (N, features)");
    if (sizes[1] != -1) flat_size_ = sizes[1];
    if (sizes[0] > 0) batch_ = sizes[0];
  }

  /// `x.view(x.size(0), -1)`: Concat(Unsqueeze(Gather(Shape(x), 0)), [-1]). Returns its last number.
  std::int64_t computed_target(const onnx::NodeProto& joined, const Origin& maps) const {
    Attributes(joined, {"axis"}).expect("axis", 0, 1);
    const Origin first = graph_.input_of(joined, 0), second = graph_.input_of(joined, 1);
    const Origin shape = gathered(unsqueezed(first));
    if (joined.input_size() != 2 || second.constant == nullptr ||
        before(shape, "Shape", "the number of windows") != maps)
      throw Refusal("its graph is another network: it does not reshape to (N, features)");
    const auto rest = integers_of(*second.constant);
    return rest.size() == 1 ? rest[0] : 0;
  }

  /// From opset 13 on the axes are an input.
  Origin unsqueezed(const Origin& origin) const {
    const onnx::NodeProto& found = node(origin, "Unsqueeze", "the number of windows");
    const Attributes attributes(found, {"axes"});
    std::vector<std::int64_t> axes = attributes.integers("axes", {});
    if (found.input_size() > 1) axes = constant_integers(graph_.input_of(found, 1));
    if (axes != std::vector<std::int64_t>{0})
      refuse_graph("the number of windows", origin, "Unsqueeze by axis 0");
    return graph_.input_of(found, 0);
  }

  Origin gathered(const Origin& origin) const {
    const onnx::NodeProto& found = node(origin, "Gather", "the number of windows");
    Attributes(found, {"axis"}).expect("axis", 0, 0);
    if (constant_integers(graph_.input_of(found, 1)) != std::vector<std::int64_t>{0})
      refuse_graph("the number of windows", origin, "Gather of the first size");
    return graph_.input_of(found, 0);
  }

  static std::vector<std::int64_t> constant_integers(const Origin& origin) {
    if (origin.constant == nullptr) refuse_graph("an axis", origin, "a constant");
    return integers_of(*origin.constant);
  }

  // ------------------------------------------------------------------ inputs
  static const onnx::TensorShapeProto& shape_of(const Origin& origin, std::string_view name, int rank) {
    if (origin.input == nullptr) refuse_graph(name, origin, "an input");
    if (origin.input->name() != name)
      throw Refusal(fmt::format("its input {} should be named '{}'", in_quotes(origin.input->name()), name),
                    names_advice);
    const auto& type = origin.input->type().tensor_type();
    if (type.elem_type() != onnx::TensorProto::FLOAT)
      throw Refusal(fmt::format("its input '{}' is not made of 32-bit floats", name), "export it as float32");
    if (type.shape().dim_size() != rank)
      throw Refusal(
          fmt::format("its input '{}' has {} dimensions, not {}", name, type.shape().dim_size(), rank));
    return type.shape();
  }

  void read_frames(const Origin& origin) {
    const auto& dims = shape_of(origin, value::frames, 4);
    network::Shape& shape = result_.shape;
    shape.frames = size_of(dims.dim(1));
    for (shape.reduction = network::min_reduction; shape.reduction <= network::max_reduction;
         ++shape.reduction)
      if (shape.rows() == size_of(dims.dim(2)) && shape.columns() == size_of(dims.dim(3))) break;
    if (shape.reduction > network::max_reduction)
      throw Refusal(fmt::format("its frames are not 24 x 32, 12 x 16 or 8 x 10 pixels but {} x {}",
                                size_of(dims.dim(2)), size_of(dims.dim(3))),
                    "only the first dimension of 'frames' may be left open when exporting");
    if (const auto fault = network::fault_of(shape)) throw Refusal("this network cannot be: " + *fault);
    if (batch_ && *batch_ != dims.dim(0).dim_value())
      throw Refusal("its graph reshapes for another number of windows than its input has");
  }

  /// 0 where it is left open, or too large to be anything.
  static int size_of(const onnx::TensorShapeProto::Dimension& dimension) {
    const std::int64_t size = dimension.dim_value();
    return size >= 0 && size <= 1000 ? static_cast<int>(size) : 0;
  }

  void check_inputs() const {
    const std::size_t needed = result_.shape.fusion ? 2 : 1;
    if (result_.shape.fusion && size_of(shape_of(gyro_, value::gyro, 2).dim(1)) != 1)
      throw Refusal("its input 'gyro' is not (N, 1)");
    if (graph_.inputs().size() != needed)
      throw Refusal(
          fmt::format("its graph has {} inputs, this network has {}", graph_.inputs().size(), needed),
          names_advice);
  }

  Graph graph_;
  NetworkGraph result_;
  Origin gyro_;
  std::int64_t flat_size_ = -1;        // what is reshaped to, -1: not said
  std::optional<std::int64_t> batch_;  // the same
};

}  // namespace

NetworkGraph network_of(const onnx::GraphProto& graph) {
  return Reading(graph).network();
}

}  // namespace thermorig::model
