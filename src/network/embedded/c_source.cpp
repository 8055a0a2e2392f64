// SPDX-License-Identifier: MIT
#include "thermorig/network/embedded/c_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <map>

#include "facts_text.h"
#include "network_text.h"
#include "thermorig/core/error.h"
#include "weights_text.h"

namespace thermorig::embedded {

namespace {

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
