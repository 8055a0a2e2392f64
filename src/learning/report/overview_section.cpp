// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "sections.h"
#include "text.h"

namespace thermorig::report {
namespace {

std::string hours_text(const StudyView& view) {
  double seconds = 0.0;
  for (const auto& result : view.results) seconds += result.seconds;
  return seconds < 600.0 ? fmt::format("{:.0f} s", seconds) : fmt::format("{:.1f} h", seconds / 3600.0);
}

std::string progress_text(const StudyView& view, const study::SettingSummary* summary) {
  return summary == nullptr ? no_result : view.folds_text(*summary);
}

/// Settings of the paper's sweeps, and of ours, that lack folds.
std::vector<std::string> gaps_of(const StudyView& view) {
  std::vector<std::string> gaps;
  for (const Setting& setting : view.settings()) {
    const study::SettingSummary* thermal = view.find(setting, false);
    const study::SettingSummary* fusion = view.find(setting, true);
    const std::string of_thermal = progress_text(view, thermal), of_fusion = progress_text(view, fusion);
    const std::string place = setting_text(setting.frames, setting.reduction);
    const bool lacks_thermal = thermal == nullptr || thermal->folds < view.folds.size();
    const bool lacks_fusion = fusion == nullptr || fusion->folds < view.folds.size();
    if (lacks_thermal && lacks_fusion && of_thermal == of_fusion) {
      gaps.push_back(fmt::format("{}: {}", place, of_thermal));
      continue;
    }
    if (lacks_thermal) gaps.push_back(fmt::format("{}, thermal-only: {}", place, of_thermal));
    if (lacks_fusion) gaps.push_back(fmt::format("{}, fusion: {}", place, of_fusion));
  }
  return gaps;
}

Paragraph completeness(const StudyView& view) {
  const auto gaps = gaps_of(view);
  if (gaps.empty()) return {"Every setting of both sweeps has all its folds."};
  return {fmt::format("Not every setting has all its folds. Missing, for the seed of the tables: {}.",
                      fmt::join(gaps, "; "))};
}

Paragraph unit(const StudyView& view) {
  return {
      fmt::format("Unit of every MSE here: (speed / {0:g} deg/s)^2, so 0.01 is an RMSE of {1:g} deg/s. The "
                  "paper does not state its unit; that it is the same is an assumption.",
                  view.label_scale_dps, 0.1 * view.label_scale_dps)};
}

Paragraph mixture() {
  return {
      "The results were computed with kernels of more than one instruction set. These round differently, "
      "which moves a fold by less than another seed does. The result files and report.json "
      "name the instruction set of each."};
}

}  // namespace

Section overview_section(const StudyView& view) {
  Table table;
  table.name = "study";
  table.header = {"what", "value"};
  table.rows = {
      {"data", view.simulated ? "SIMULATED rig" : "real"},
      {"results (trainings with their test)", count_text(view.results.size())},
      {"folds: acquisitions left out in turn, as the results show", count_text(view.folds.size())},
      {"label, learnt and tested against", column_of(view.label)},
      {"preset", clean(view.preset)},
      {"epochs", std::to_string(view.epochs)},
      {"settings", clean(view.settings_text)},
      {"valid frames in a row at every window's end", std::to_string(view.history)},
      {"seeds", fmt::format("{}", fmt::join(view.seeds, ", "))},
      {"seed of the tables", std::to_string(view.table_seed)},
      {"instruction set", clean(study::instruction_sets_of(view.results))},
      {"time of all jobs, added up", hours_text(view)},
      {"data hash", clean(view.data_hash)},
  };
  std::erase_if(table.rows, [](const auto& row) { return row[1].empty(); });
  Section section{"What was run", {completeness(view), unit(view), table}};
  if (study::mixes_instruction_sets(view.results)) section.blocks.push_back(mixture());
  return section;
}

}  // namespace thermorig::report
