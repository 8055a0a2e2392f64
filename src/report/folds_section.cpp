// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "sections.h"
#include "text.h"

namespace thermorig::report {
namespace {

Table setup_table(const StudyView& view, bool fusion) {
  Table table;
  table.caption =
      fmt::format("Test MSE fold by fold, {}, seed {}", fusion ? "fusion" : "thermal-only", view.table_seed);
  table.header = {"fold"};
  for (const Setting& setting : view.settings())
    table.header.push_back(setting_text(setting.frames, setting.reduction));
  const auto index = static_cast<std::size_t>(estimator_of(fusion));
  for (const std::string& fold : view.folds) {
    std::vector<std::string> row{clean(fold)};
    for (const Setting& setting : view.settings()) {
      const study::JobResult* result = view.job(setting, fusion, fold);
      row.push_back(result == nullptr ? no_result : mse_text(result->evaluation.errors[index].mse));
    }
    table.rows.push_back(row);
  }
  return table;
}

std::string detail_cell(const study::Errors& errors) {
  return fmt::format("{} / {} / {} / {} / {}", rate_text(errors.rmse_dps), rate_text(errors.median_dps),
                     rate_text(errors.p95_dps), share_text(errors.outlier_share), rate_text(errors.bias_dps));
}

/// RMSE, median and 95th percentile of |error|, outliers, bias: of all estimators at the reference.
Table detail_table(const StudyView& view) {
  Table table;
  table.caption = view.reference_text() +
                  " in deg/s: RMSE / median |error| / 95th percentile / |error| above 30 deg/s / mean "
                  "error";
  table.header = {"fold", "windows"};
  for (const auto estimator : study::all_estimators) table.header.push_back(label_of(estimator));
  for (const std::string& fold : view.folds) {
    const study::JobResult* thermal = view.job(view.reference, false, fold);
    const study::JobResult* fusion = view.job(view.reference, true, fold);
    const study::JobResult* any = fusion != nullptr ? fusion : thermal;
    if (any == nullptr) continue;
    const auto& gyro = any->evaluation.errors;
    table.rows.push_back({clean(fold),
                          count_text(thermal != nullptr ? thermal->evaluation.errors[0].windows
                                                        : any->evaluation.errors[1].windows),
                          thermal == nullptr ? no_result : detail_cell(thermal->evaluation.errors[0]),
                          fusion == nullptr ? no_result : detail_cell(fusion->evaluation.errors[1]),
                          detail_cell(gyro[2]), detail_cell(gyro[3])});
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
