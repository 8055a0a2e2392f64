// SPDX-License-Identifier: MIT
#include "weights_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "facts_text.h"
#include "quantisation.h"

namespace thermorig::embedded {

namespace {

/// How many constants scaling_text() has.
std::size_t scaling_values(const network::Scaling& scaling) {
  return scaling.by_window ? 2 : 3;
}
constexpr std::size_t floats_a_line = 8, bytes_a_line = 24;

template <typename Value, typename Text>
std::string array_text(std::string_view type, const std::string& name, std::string_view comment,
                       std::span<const Value> values, std::size_t a_line, Text text_of) {
  std::string text =
      fmt::format("static const {} {}[{}] = {{ /* {} */\n", type, name, values.size(), comment);
  for (std::size_t i = 0; i < values.size(); ++i) {
    text += i % a_line == 0 ? "  " : " ";
    text += text_of(values[i]);
    if (i + 1 < values.size()) text += ',';
    if (i % a_line == a_line - 1 && i + 1 < values.size()) text += '\n';
  }
  return text + "\n};\n";
}

std::string floats_text(const std::string& name, std::string_view comment, std::span<const float> values,
                        std::string_view type = "float") {
  return array_text(type, name, comment, values, floats_a_line, float_text);
}

std::string shape_text(const std::vector<int>& dimensions) {
  return fmt::format("({})", fmt::join(dimensions, ", "));
}

std::string weight_arrays(const std::string& layer, const network::Tensor& tensor,
                          std::span<const float> values, WeightKind kind) {
  const std::string shape = shape_text(tensor.dimensions);
  if (kind == WeightKind::float32) return floats_text(layer + "_weights", shape, values, "network_weight");
  const Quantised small = quantise(values, static_cast<std::size_t>(tensor.dimensions.front()));
  return array_text("network_weight", layer + "_weights", shape + ", each times the scale of its row",
                    std::span<const std::int8_t>(small.values), bytes_a_line,
                    [](std::int8_t value) { return fmt::to_string(int{value}); }) +
         floats_text(layer + "_scale", "a row", small.scales);
}

std::string layer_text(const network::Weights& weights, const network::Tensor& tensor, WeightKind kind) {
  const std::string layer(tensor.name.substr(0, tensor.name.find('.')));
  const std::string biases = floats_text(layer + "_bias", "a row", weights.tensor(layer + ".bias"));
  const auto values = weights.tensor(tensor.name);
  if (!fits_8_bits(tensor))  // float32 in either kind
    return fmt::format("\n{}{}", floats_text(layer + "_weights", shape_text(tensor.dimensions), values),
                       biases);
  const std::string scale = kind == WeightKind::int8 ? layer + "_scale, " : "";
  return fmt::format("\n{1}{2}static const network_layer {0} = {{{0}_weights, {3}{0}_bias}};\n", layer,
                     weight_arrays(layer, tensor, values, kind), biases, scale);
}

std::string scaling_text(const network::Scaling& scaling) {
  const auto constant = [](std::string_view name, float value, std::string_view comment) {
    return fmt::format("static const float {} = {}; /* {} */\n", name, float_text(value), comment);
  };
  const std::string label =
      constant("label_scale_dps", scaling.label_scale_dps, "deg/s that the network calls 1");
  if (scaling.by_window)
    return label + constant("frame_period_s", scaling.frame_period_s,
                            "where a frame comes so many seconds after another");
  return label +
         constant("temp_mean_c", scaling.temp_mean_c, "of the training data's pixels, degrees Celsius") +
         constant("temp_deviation_c", scaling.temp_deviation_c, "the same");
}

std::string types_text(WeightKind kind) {
  const bool small = kind == WeightKind::int8;
  return fmt::format(
      "#include <stdint.h>\n\ntypedef {} network_weight;\n\n"
      "/* A layer's constants, row by row: a row is what one output is made of. */\n"
      "typedef struct {{\n  const network_weight* weights;\n{}  const float* bias;\n}} "
      "network_layer;\n",
      small ? "int8_t" : "float", small ? "  const float* scale;\n" : "");
}

}  // namespace

std::string float_text(float value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text + "f";
}

std::size_t constant_bytes(const model::Model& model, WeightKind kind) {
  std::size_t bytes = scaling_values(model.scaling) * sizeof(float);
  for (const network::Tensor& tensor : network::tensors_of(model.weights.shape)) {
    const bool small = kind == WeightKind::int8 && fits_8_bits(tensor);
    bytes += small ? tensor.size + sizeof(float) * static_cast<std::size_t>(tensor.dimensions.front())
                   : sizeof(float) * tensor.size;
  }
  return bytes;
}

std::string weights_text(const model::Model& model, WeightKind kind) {
  std::string text = fmt::format(
      "/* SPDX-License-Identifier: MIT\n *\n{}\n *\n{}\n */\n#ifndef NETWORK_WEIGHTS_H\n#define "
      "NETWORK_WEIGHTS_H\n\n{}\n{}",
      facts_text(model, kind), data_text(model.provenance), types_text(kind), scaling_text(model.scaling));
  for (const network::Tensor& tensor : network::tensors_of(model.weights.shape))
    if (!is_bias(tensor)) text += layer_text(model.weights, tensor, kind);
  return text + "\n#endif\n";
}

}  // namespace thermorig::embedded
