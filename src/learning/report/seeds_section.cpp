// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "sections.h"
#include "seed_spread.h"
#include "text.h"

namespace thermorig::report {
namespace {

std::vector<std::string> seed_row(const StudyView& view, std::uint64_t seed) {
  std::vector<std::string> row{std::to_string(seed)};
  for (const bool fusion : {false, true}) {
    const study::SettingSummary* summary = view.find(view.reference, fusion, seed);
    if (summary == nullptr) {
      row.insert(row.end(), {no_result, no_value, no_value});
      continue;
    }
    const double median = median_of(*summary);
    row.push_back(fmt::format("{} ({})", mse_text(median), rate_text(rmse_of(median, view.label_scale_dps))));
    row.push_back(summary->folds < 2 ? no_value : mse_text(iqr_of(*summary)));
    row.push_back(fmt::format("{} of {}", summary->folds, view.folds.size()));
  }
  return row;
}

}  // namespace

Section seeds_section(const StudyView& view) {
  Table table;
  table.name = "seeds";
  table.caption =
      fmt::format("{} with each seed, {}: MSE (RMSE in deg/s)", view.reference_text(), view.ours());
  table.groups = {{"", 1}, {"thermal-only", 3}, {"fusion", 3}};
  table.header = {"seed", "median", "IQR", "folds", "median", "IQR", "folds"};
  for (const std::uint64_t seed : view.seeds)
    if (view.find(view.reference, false, seed) != nullptr || view.find(view.reference, true, seed) != nullptr)
      table.rows.push_back(seed_row(view, seed));
  if (table.rows.empty())
    return {"Spread over seeds", {Paragraph{"No result at " + view.reference_text() + "."}}};
  return {"Spread over seeds",
          {Paragraph{"The same folds trained again from other first weights and another order of windows: "
                     "differences between settings that are no larger than these mean nothing."},
           table}};
}

}  // namespace thermorig::report
