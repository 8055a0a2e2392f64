// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "thermorig/learning/study/study.h"

namespace thermorig::study {

namespace {

std::map<std::string, std::size_t> counts_of(std::span<const JobResult> results) {
  std::map<std::string, std::size_t> counts;
  for (const JobResult& result : results) ++counts[result.instruction_set];
  return counts;
}

}  // namespace

std::string instruction_sets_of(std::span<const JobResult> results) {
  const auto counts = counts_of(results);
  if (counts.size() == 1) return counts.begin()->first;
  std::vector<std::pair<std::string, std::size_t>> sets(counts.begin(), counts.end());
  std::ranges::stable_sort(sets, std::ranges::greater(), [](const auto& set) { return set.second; });
  std::vector<std::string> texts;
  for (const auto& [name, count] : sets)
    texts.push_back(fmt::format("{} ({} result{})", name, count, count == 1 ? "" : "s"));
  return fmt::format("{}", fmt::join(texts, ", "));
}

bool mixes_instruction_sets(std::span<const JobResult> results) {
  return counts_of(results).size() > 1;
}

}  // namespace thermorig::study
