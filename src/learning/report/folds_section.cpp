// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "sections.h"
#include "text.h"

namespace thermorig::report {
namespace {

Table setup_table(const StudyView& view, bool fusion) {
  Table table;
  table.name = fusion ? "folds-fusion" : "folds-thermal";
  table.caption =
      fmt::format("Test MSE fold by fold, {}, seed {}", fusion ? "fusion" : "thermal-only", view.table_seed);
  table.header = {"fold"};
  for (const Setting& setting : view.settings())
    table.header.push_back(setting_text(setting.frames, setting.reduction));
  for (const std::string& fold : view.folds) {
    std::vector<std::string> row{clean(fold)};
    for (const Setting& setting : view.settings()) {
      const study::JobResult* result = view.job(setting, fusion, fold);
      row.push_back(result == nullptr ? no_result
                                      : mse_text(result->evaluation.errors[estimator_of(fusion)].mse));
    }
    table.rows.push_back(row);
  }
  return table;
}

std::string detail_cell(const study::Errors& errors) {
  return fmt::format("{} / {} / {} / {} / {}", rate_text(errors.rmse_dps), rate_text(errors.median_dps),
                     rate_text(errors.p95_dps), share_text(errors.outlier_share),
                     rate_text(errors.mean_error_dps));
}

/// RMSE, median and 95th percentile of |error|, outliers, bias: of all estimators at the reference.
Table detail_table(const StudyView& view) {
  Table table;
  table.name = "folds";
  table.caption = view.reference_text() +
                  " in deg/s: RMSE / median |error| / 95th percentile / |error| above 30 deg/s / mean "
                  "error";
  table.header = {"fold", "windows"};
  table.header.insert(table.header.end(), view.estimators.begin(), view.estimators.end());
  for (const std::string& fold : view.folds) {
    const study::JobResult* thermal = view.job(view.reference, false, fold);
    const study::JobResult* own = thermal != nullptr ? thermal : view.job(view.reference, true, fold);
    if (own == nullptr) continue;
    std::vector<std::string> row{clean(fold),
                                 count_text(own->evaluation.errors[estimator_of(own->job.fusion)].windows)};
    for (const std::string& name : view.estimators) {
      const study::JobResult* result = view.job_of(name, fold);
      row.push_back(result == nullptr ? no_result : detail_cell(result->evaluation.errors[name]));
    }
    table.rows.push_back(row);
  }
  return table;
}

}  // namespace

Section folds_section(const StudyView& view) {
  Section section{"Fold by fold", {setup_table(view, false), setup_table(view, true)}};
  Table details = detail_table(view);
  if (!details.rows.empty()) section.blocks.push_back(std::move(details));
  return section;
}

}  // namespace thermorig::report
