// SPDX-License-Identifier: MIT
#include "thermorig/core/nearest_name.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace thermorig {

namespace {

/// "nf" of "--nf": the dashes of two options would make them alike.
std::string_view without_dashes(std::string_view name) {
  return name.substr(std::min(name.find_first_not_of('-'), name.size()));
}

/// Characters to insert, remove or replace, and neighbours to swap (optimal string alignment).
std::size_t edits_between(std::string_view from, std::string_view to) {
  from = without_dashes(from);
  to = without_dashes(to);
  std::vector<std::size_t> row(to.size() + 1), last, before_last;
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < from.size(); ++i) {
    before_last = std::exchange(last, row);
    row[0] = i + 1;
    for (std::size_t j = 0; j < to.size(); ++j) {
      row[j + 1] = std::min({last[j] + (from[i] == to[j] ? 0 : 1), last[j + 1] + 1, row[j] + 1});
      if (i > 0 && j > 0 && from[i] == to[j - 1] && from[i - 1] == to[j])
        row[j + 1] = std::min(row[j + 1], before_last[j - 1] + 1);
    }
  }
  return row.back();
}

constexpr std::size_t longest_compared = 64;

bool is_near(std::string_view unknown, const std::string& name) {
  return without_dashes(unknown).size() > 1 &&
         2 * edits_between(unknown, name) <= without_dashes(name).size();
}

}  // namespace

std::optional<std::string> nearest_name(std::string_view unknown, std::span<const std::string> names) {
  unknown = unknown.substr(0, longest_compared);
  const auto nearest = std::ranges::min_element(
      names, {}, [unknown](const std::string& name) { return edits_between(unknown, name); });
  return nearest != names.end() && is_near(unknown, *nearest) ? std::optional(*nearest) : std::nullopt;
}

std::string advice_on_name(std::string_view unknown, std::span<const std::string> names) {
  unknown = unknown.substr(0, longest_compared);
  std::vector<std::string> sorted(names.begin(), names.end());
  std::stable_sort(sorted.begin(), sorted.end(), [&](const std::string& a, const std::string& b) {
    return edits_between(unknown, a) < edits_between(unknown, b);
  });
  const std::string& nearest = sorted.front();
  std::string advice = is_near(unknown, nearest) ? "did you mean \"" + nearest + "\"? one of: " : "one of: ";
  for (const std::string& name : sorted) advice += (&name == &nearest ? "" : ", ") + name;
  return advice;
}

}  // namespace thermorig
