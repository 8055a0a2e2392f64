// SPDX-License-Identifier: MIT
#include "thermorig/rig/profile/toml_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>
#include <toml.hpp>
#include <utility>

#include "thermorig/core/error.h"
#include "thermorig/core/nearest_name.h"
#include "thermorig/rig/profile/toml_text.h"

namespace thermorig::rig {

/// Of a text as it was read: the parser has seen one whose lines are shorter.
struct TomlSource {
  std::string file_name;
  std::vector<std::size_t> lines;

  std::string place(std::size_t line) const {
    return line == 0 ? file_name : fmt::format("{}:{}", file_name, lines[std::min(line, lines.size()) - 1]);
  }
};

struct TomlTable::Node {
  toml::value value;
  std::shared_ptr<const TomlSource> source;

  /// Counts the lines before it: only for an error.
  std::string place() const { return source->place(value.location().line()); }
};

namespace {

[[noreturn]] void refuse_at(const std::string& where, const std::string& what, const std::string& advice) {
  throw Error(ExitCode::bad_usage, what, where, advice);
}

// The library's message is a drawing of the text; its line number is what people need.
[[noreturn]] void refuse_syntax(const toml::syntax_error& error, const TomlSource& source) {
  std::string first = error.what();
  first = first.substr(0, first.find('\n'));
  const std::string mark = "[error] ";
  if (const auto at = first.find(mark); at != std::string::npos) first.erase(0, at + mark.size());
  refuse_at(source.place(error.location().line()), "not valid TOML: " + first,
            "correct that line; the format is described on https://toml.io");
}

bool says_anything(const toml::value& value) {
  if (!value.is_table()) return true;
  const auto& table = value.as_table();
  return std::any_of(table.begin(), table.end(),
                     [](const auto& entry) { return says_anything(entry.second); });
}

}  // namespace

TomlTable::TomlTable(std::shared_ptr<const Node> node) : node_(std::move(node)) {}

TomlTable TomlTable::parse(const std::string& text, const std::string& file_name) {
  TomlText prepared = prepared_toml(text, file_name);
  const auto source = std::make_shared<const TomlSource>(TomlSource{file_name, std::move(prepared.lines)});
  std::istringstream stream(prepared.text + "\n");
  try {
    return TomlTable(std::make_shared<const Node>(Node{toml::parse(stream, file_name), source}));
  } catch (const toml::syntax_error& error) {
    refuse_syntax(error, *source);
  }
}

bool TomlTable::is_empty() const {
  return !says_anything(node_->value);
}

bool TomlTable::has(const std::string& key) const {
  return node_->value.contains(key);
}

std::optional<TomlTable::Node> TomlTable::find(const std::string& key) {
  known_.push_back(key);
  if (!has(key)) return std::nullopt;
  return Node{node_->value.at(key), node_->source};
}

double TomlTable::checked_number(const std::string& key, const Node& node, double min, double max) const {
  const toml::value& value = node.value;
  const auto refuse = [&](const std::string& what) {
    refuse_at(node.place(), what, fmt::format("a number from {} to {}", min, max));
  };
  if (!value.is_integer() && !value.is_floating()) refuse(key + " is not a number");
  const double number =
      value.is_integer() ? static_cast<double>(value.as_integer()) : static_cast<double>(value.as_floating());
  if (!(number >= min && number <= max)) refuse(fmt::format("{} = {} is out of range", key, number));
  return number;
}

std::optional<double> TomlTable::number(const std::string& key, double min, double max) {
  const auto node = find(key);
  if (!node) return std::nullopt;
  return checked_number(key, *node, min, max);
}

std::optional<std::int64_t> TomlTable::integer(const std::string& key, std::int64_t min, std::int64_t max) {
  const auto node = find(key);
  if (!node) return std::nullopt;
  const std::string where = node->place();
  const std::string advice = fmt::format("a whole number from {} to {}", min, max);
  if (!node->value.is_integer()) refuse_at(where, key + " is not a whole number", advice);
  const std::int64_t number = node->value.as_integer();
  if (number < min || number > max)
    refuse_at(where, fmt::format("{} = {} is out of range", key, number), advice);
  return number;
}

std::optional<bool> TomlTable::boolean(const std::string& key) {
  const auto node = find(key);
  if (!node) return std::nullopt;
  if (!node->value.is_boolean())
    refuse_at(node->place(), key + " is neither true nor false", "true or false");
  return node->value.as_boolean();
}

std::optional<std::string> TomlTable::text(const std::string& key) {
  const auto node = find(key);
  if (!node) return std::nullopt;
  if (!node->value.is_string()) refuse_at(node->place(), key + " is not text", "text in quotation marks");
  return node->value.as_string().str;
}

std::optional<std::vector<double>> TomlTable::numbers(const std::string& key, double min, double max,
                                                      std::size_t count_max) {
  const auto node = find(key);
  if (!node) return std::nullopt;
  if (!node->value.is_array()) refuse_at(node->place(), key + " is not a list", "numbers in [ ]");
  const toml::array& values = node->value.as_array();
  if (values.size() > count_max)
    refuse_at(node->place(), fmt::format("{} has {} numbers", key, values.size()),
              fmt::format("at most {}", count_max));
  std::vector<double> numbers;
  for (const toml::value& value : values)
    numbers.push_back(checked_number(key, Node{value, node->source}, min, max));
  return numbers;
}

std::optional<std::size_t> TomlTable::choice(const std::string& key,
                                             const std::vector<std::string>& allowed) {
  const auto word = text(key);
  if (!word) return std::nullopt;
  const auto found = std::find(allowed.begin(), allowed.end(), *word);
  if (found == allowed.end())
    refuse(key, fmt::format("{} = \"{}\" is not known", key, *word), advice_on_name(*word, allowed));
  return static_cast<std::size_t>(found - allowed.begin());
}

TomlTable TomlTable::table(const std::string& key) {
  const auto node = find(key);
  if (!node) return TomlTable(std::make_shared<const Node>(Node{toml::table{}, node_->source}));
  if (!node->value.is_table()) refuse_at(node->place(), key + " is not a table", fmt::format("[{}]", key));
  return TomlTable(std::make_shared<const Node>(*node));
}

void TomlTable::refuse_unknown() const {
  for (const auto& [key, value] : node_->value.as_table()) {
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    refuse_at(Node{value, node_->source}.place(), fmt::format("unknown key \"{}\"", key),
              known_.empty() ? "leave it out: nothing belongs there" : advice_on_name(key, known_));
  }
}

void TomlTable::refuse(const std::string& key, const std::string& what, const std::string& advice) const {
  refuse_at(has(key) ? Node{node_->value.at(key), node_->source}.place() : node_->source->file_name, what,
            advice);
}

std::string toml_quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char character : text) {
    const auto code = static_cast<unsigned char>(character);
    if (character == '"' || character == '\\')
      quoted += {'\\', character};
    else if (code < 0x20 || code == 0x7F)
      quoted += fmt::format("\\u{:04X}", code);
    else
      quoted += character;
  }
  return quoted + "\"";
}

}  // namespace thermorig::rig
