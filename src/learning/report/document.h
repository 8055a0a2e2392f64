// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace thermorig::report {

// A report before it is written as Markdown or HTML. All texts are plain: the writers escape them.

struct Paragraph {
  std::string text;
};

/// Neighbouring columns under one common title; an empty title for none.
struct ColumnGroup {
  std::string title;
  std::size_t columns = 1;
};

struct Table {
  std::string name;  // of its files, see plots.h
  std::string caption;
  std::vector<ColumnGroup> groups;  // left to right over all columns, or empty
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  bool folded = false;                                   // long: shown on demand where the medium can
  std::optional<std::size_t> emphasised = std::nullopt;  // column that the eye should find
};

/// A plot. `label` says in a sentence what it shows, for those who cannot see it; `data` is what
/// charts/page.js takes, chosen by its member "kind".
struct Chart {
  std::string name;  // of its file, see plots.h
  std::string title;
  std::string label;
  nlohmann::json data;
};

/// Plots side by side where there is room. The figures of each stand in a table of the same section.
struct Charts {
  std::vector<Chart> charts;
  bool small = false;  // many of a kind
};

/// Columns of figures alone, which stand on the right; text.h says how figures look.
std::vector<bool> number_columns(const Table& table);

using Block = std::variant<Paragraph, Table, Charts>;

struct Section {
  std::string heading;
  std::vector<Block> blocks;
};

struct Document {
  std::string title;
  std::string banner;  // what nobody may overlook; empty for nothing
  std::vector<Section> sections;
};

}  // namespace thermorig::report
