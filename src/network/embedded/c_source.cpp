// SPDX-License-Identifier: MIT
#include "thermorig/network/embedded/c_source.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "network_text.h"
#include "quantisation.h"
#include "thermorig/core/error.h"

namespace thermorig::embedded {

namespace {

constexpr std::size_t longest_comment = 100;

/// Text from outside, which anybody may have written, as a part of a comment of C: it can neither end the
/// comment nor begin a line.
std::string comment_safe(std::string_view text) {
  std::string safe;
  for (char c : text.substr(0, longest_comment)) {
    const bool harmless = c >= ' ' && c <= '~' && c != '\\' && c != '?' && c != '@';
    const bool end_or_begin =
        !safe.empty() && ((safe.back() == '*' && c == '/') || (safe.back() == '/' && c == '*'));
    if (end_or_begin) safe += ' ';
    safe += harmless ? c : '_';
  }
  return safe;
}

/// Lines of a comment.
std::string comment(const std::vector<std::string>& lines) {
  return fmt::format(" * {}", fmt::join(lines, "\n * "));
}

std::string stated(std::string_view text) {
  return text.empty() ? "not stated" : comment_safe(text);
}

std::string training_text(const model::Provenance& provenance) {
  return fmt::format("Model: made by {}, preset {}, label {}, seed {}, weights of epoch {} of {}.",
                     stated(provenance.producer), stated(provenance.preset),
                     provenance.label ? name_of(*provenance.label) : stated(""), provenance.seed,
                     provenance.epoch_kept, provenance.epochs);
}

std::string network_text(const network::Shape& shape, WeightKind kind) {
  return fmt::format("Network: Nf {}, Nr {}, {}, {} weights as {}.", shape.frames, shape.reduction,
                     shape.fusion ? "thermal and gyro" : "thermal-only", network::weight_count(shape),
                     kind == WeightKind::int8 ? "int8" : "float32");
}

void add_list(std::vector<std::string>& lines, std::string_view title,
              const std::vector<model::Provenance::Data>& data) {
  if (data.empty()) return;
  lines.push_back(fmt::format("{}, each with the SHA-256 of what was used of it:", title));
  for (const model::Provenance::Data& acquisition : data)
    lines.push_back(fmt::format("  {} {}", comment_safe(acquisition.name), comment_safe(acquisition.hash)));
}

/// What every file says of its model.
std::string facts_text(const model::Model& model, WeightKind kind) {
  const model::Provenance& provenance = model.provenance;
  std::vector<std::string> lines{
      "Rotational speed from a thermal camera and a gyro, for small boards. Written by "
      "thermorig " THERMORIG_VERSION ".",
      network_text(model.weights.shape, kind), training_text(provenance)};
  if (provenance.simulated)
    lines.emplace_back("TRAINED ON SIMULATED DATA: what it is worth on a real camera is not known.");
  lines.push_back("Licence of the training data: " + stated(provenance.data_licence) + ".");
  return comment(lines);
}

/// Which recordings it was trained on.
std::string data_text(const model::Provenance& provenance) {
  std::vector<std::string> lines;
  add_list(lines, "Trained on", provenance.training);
  add_list(lines, "Epoch chosen on", provenance.held_out);
  if (lines.empty()) lines.emplace_back("Training data: not stated.");
  return comment(lines);
}

/// A number as C writes it, which reads back as the same float: shortest decimal. (Hexadecimal would be C99,
/// but C++ only since 2017.)
std::string float_text(float value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text + "f";
}

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

/// Flash that they take.
std::size_t constant_bytes(const model::Model& model, WeightKind kind) {
  std::size_t bytes = scaling_values(model.scaling) * sizeof(float);
  for (const network::Tensor& tensor : network::tensors_of(model.weights.shape)) {
    const bool small = kind == WeightKind::int8 && fits_8_bits(tensor);
    bytes += small ? tensor.size + sizeof(float) * static_cast<std::size_t>(tensor.dimensions.front())
                   : sizeof(float) * tensor.size;
  }
  return bytes;
}

/// The file of constants: scaling, then layer by layer weights, scales and biases.
std::string weights_text(const model::Model& model, WeightKind kind) {
  std::string text = fmt::format(
      "/* SPDX-License-Identifier: MIT\n *\n{}\n *\n{}\n */\n#ifndef NETWORK_WEIGHTS_H\n#define "
      "NETWORK_WEIGHTS_H\n\n{}\n{}",
      facts_text(model, kind), data_text(model.provenance), types_text(kind), scaling_text(model.scaling));
  for (const network::Tensor& tensor : network::tensors_of(model.weights.shape))
    if (!is_bias(tensor)) text += layer_text(model.weights, tensor, kind);
  return text + "\n#endif\n";
}

using Words = std::map<std::string, std::string, std::less<>>;

constexpr std::string_view prefix = "thermorig_network";

constexpr std::size_t longest_name = 48;

// A folder with a file of such a name hides the compiler's own header.
constexpr std::array<std::string_view, 24> standard_headers{
    "assert", "complex", "ctype",  "errno",  "fenv",   "float",  "inttypes", "iso646",
    "limits", "locale",  "math",   "setjmp", "signal", "stdarg", "stdbool",  "stddef",
    "stdint", "stdio",   "stdlib", "string", "tgmath", "time",   "wchar",    "wctype"};

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

bool is_name(const std::string& name) {
  const auto allowed = [](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; };
  return !name.empty() && name.size() <= longest_name && is_letter(name.front()) &&
         std::all_of(name.begin(), name.end(), allowed) &&
         std::find(standard_headers.begin(), standard_headers.end(), name) == standard_headers.end();
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

std::string upper(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  return result;
}

/// Throws Error(bad_usage) if files and symbols of C cannot begin with it.
void require_name(const std::string& name) {
  if (is_name(name)) return;
  throw Error(ExitCode::bad_usage, "files and symbols cannot have this name", name,
              "letters, digits and _, a letter first, at most 48, and no standard header's name");
}

/// C whose files and symbols begin with `prefix`, in capitals too, with `name` in its place.
std::string renamed(std::string_view text, const std::string& name) {
  std::string result(text);
  // by way of a word that no name can hold: the name may contain what is replaced
  replace_all(result, prefix, "@1");
  replace_all(result, upper(prefix), "@2");
  replace_all(result, "@1", name);
  replace_all(result, "@2", upper(name));
  return result;
}

/// Puts the words in where the text has them between two @, once: what was put in is not looked at again.
std::string filled(std::string_view text, const Words& words) {
  std::string result;
  for (std::size_t at = text.find('@'); at != std::string_view::npos; at = text.find('@')) {
    const std::size_t end = text.find('@', at + 1);
    result += text.substr(0, at);
    const auto word = words.find(text.substr(at + 1, end - at - 1));
    assert(word != words.end());
    result += word->second;
    text.remove_prefix(end + 1);
  }
  return result.append(text);
}

std::size_t to_words(std::size_t bytes) {
  return (bytes + 3) / 4 * 4;
}

/// sizeof of the state that c99/thermorig_network.h declares.
std::size_t state_bytes(const model::Model& model, bool integer) {
  const network::Shape& shape = model.weights.shape;
  const auto frames = static_cast<std::size_t>(shape.frames);
  const auto pooled =
      static_cast<std::size_t>(network::filters1 * shape.pooled_rows() * shape.pooled_columns());
  const auto plane = static_cast<std::size_t>(shape.rows2() * shape.columns2());
  const std::size_t floats = frames + pooled + plane + 2 * network::hidden1;
  const std::size_t ring = shape.inputs() * (integer ? sizeof(std::int16_t) : sizeof(float));
  const std::size_t degrees = model.scaling.by_window ? shape.inputs() * sizeof(float) : 0;
  const std::size_t values = pooled + plane;
  return to_words(ring) + degrees + 2 * sizeof(std::int32_t) + sizeof(float) * floats +
         (integer ? to_words(sizeof(std::int16_t) * values) : 0);
}

Words words_of(const model::Model& model, WeightKind kind) {
  const network::Shape& shape = model.weights.shape;
  const bool int8 = kind == WeightKind::int8;
  return {{"facts", facts_text(model, kind)},
          {"frames", fmt::to_string(shape.frames)},
          {"reduction", fmt::to_string(shape.reduction)},
          {"crop_left", fmt::to_string(shape.crop_left)},
          {"rows", fmt::to_string(shape.rows())},
          {"columns", fmt::to_string(shape.columns())},
          {"fusion", shape.fusion ? "1" : "0"},
          {"padding1", fmt::to_string(shape.padding1)},
          {"padding2", fmt::to_string(shape.padding2)},
          {"pooled_rows", fmt::to_string(shape.pooled_rows())},
          {"pooled_columns", fmt::to_string(shape.pooled_columns())},
          {"rows2", fmt::to_string(shape.rows2())},
          {"columns2", fmt::to_string(shape.columns2())},
          {"int8", int8 ? "1" : "0"},
          {"by_window", model.scaling.by_window ? "1" : "0"},
          {"constant_bytes", fmt::to_string(constant_bytes(model, kind))},
          {"integer_state_bytes", fmt::to_string(state_bytes(model, true))},
          {"float_state_bytes", fmt::to_string(state_bytes(model, false))}};
}

}  // namespace

CSource c_source(const model::Model& model, WeightKind kind, const std::string& name) {
  require_name(name);
  const Words words = words_of(model, kind);
  CSource source;
  source.files.push_back({name + ".h", filled(renamed(network_h, name), words)});
  source.files.push_back({name + ".c", filled(renamed(network_c, name), words)});
  source.files.push_back({name + "_weights.h", weights_text(model, kind)});
  source.constant_bytes = constant_bytes(model, kind);
  source.working_bytes = state_bytes(model, kind == WeightKind::int8);
  return source;
}

}  // namespace thermorig::embedded
