// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace thermorig::rig {

/// A table of a TOML text, read key by key. Everything that is wrong is thrown as Error(bad_usage) with file,
/// line and what is allowed. Keys nobody asked for are refused by refuse_unknown().
class TomlTable {
 public:
  static TomlTable parse(const std::string& text, const std::string& file_name);

  std::optional<double> number(const std::string& key, double min, double max);
  std::optional<std::int64_t> integer(const std::string& key, std::int64_t min, std::int64_t max);
  std::optional<bool> boolean(const std::string& key);
  std::optional<std::string> text(const std::string& key);
  /// A list of at most `count_max`.
  std::optional<std::vector<double>> numbers(const std::string& key, double min, double max,
                                             std::size_t count_max);
  /// Index of the word among `allowed`.
  std::optional<std::size_t> choice(const std::string& key, const std::vector<std::string>& allowed);
  /// The table of that name; one without keys if there is none.
  TomlTable table(const std::string& key);

  /// No key in it or its tables.
  bool is_empty() const;
  bool has(const std::string& key) const;
  void refuse_unknown() const;
  /// Throws: `what` at the line of `key` (of the whole file if it is not there).
  [[noreturn]] void refuse(const std::string& key, const std::string& what, const std::string& advice) const;

 private:
  struct Node;
  explicit TomlTable(std::shared_ptr<const Node> node);
  double checked_number(const std::string& key, const Node& value, double min, double max) const;
  std::optional<Node> find(const std::string& key);

  std::shared_ptr<const Node> node_;
  std::vector<std::string> known_;
};

/// A TOML string: quoted and escaped.
std::string toml_quoted(const std::string& text);

}  // namespace thermorig::rig
