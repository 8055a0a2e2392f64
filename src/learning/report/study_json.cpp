// SPDX-License-Identifier: MIT
#include "claims.h"
#include "drift_figures.h"
#include "json_values.h"
#include "paper_figures.h"
#include "sections.h"
#include "seed_spread.h"
#include "thermorig/learning/report/report.h"

namespace thermorig::report {
namespace {

using nlohmann::json;

json paper_json() {
  json rows = json::array();
  for (const PaperRow& row : paper_rows)
    rows.push_back({{"frames", row.frames},
                    {"reduction", row.reduction},
                    {"median_thermal", row.median_thermal},
                    {"median_fusion", row.median_fusion},
                    {"iqr_thermal", row.iqr_thermal},
                    {"iqr_fusion", row.iqr_fusion}});
  return {{"data", "real"}, {"unit", "not stated by the paper"}, {"rows", rows}};
}

json setting_json(const StudyView& view, const study::SettingSummary& summary) {
  const Setting setting{summary.frames, summary.reduction};
  json folds = json::array();
  for (const study::JobResult* result : view.jobs(setting, summary.fusion, summary.seed)) {
    folds.push_back({{"test", result->job.test},
                     {"instruction_set", result->instruction_set},
                     {"errors", errors_json(result->evaluation.errors)},
                     {"shaft_errors", errors_json(result->evaluation.shaft_errors)},
                     {"gain", gain_json(result->evaluation.gain)}});
    if (!result->evaluation.angles.empty())
      folds.back()["angle"] = drift_json(result->evaluation.angles.front());
  }
  json estimators;
  for (const std::string& name : study::all_estimators())
    estimators[name] = {{"median_mse", summary.mse[name].median},
                        {"iqr_mse", summary.mse[name].iqr},
                        {"rmse_dps", summary.rmse_dps[name]},
                        {"fold_mse", summary.fold_mse[name]}};
  return {{"frames", summary.frames},
          {"reduction", summary.reduction},
          {"fusion", summary.fusion},
          {"seed", summary.seed},
          {"folds_done", summary.folds},
          {"folds_of_study", view.folds.size()},
          {"estimators", estimators},
          {"gain", gain_json(summary.gain)},
          {"weights", summary.weights},
          {"multiply_adds", summary.multiply_adds},
          {"folds", folds}};
}

json claims_json(const StudyView& view) {
  json claims = json::array();
  for (const Claim& claim : claims_of(view))
    claims.push_back({{"key", claim.key},
                      {"statement", claim.statement},
                      {"verdict", text_of(claim.verdict, seeds_known(view))},
                      {"evidence", claim.evidence},
                      {"of_paper", claim.of_paper}});
  return claims;
}

json study_of(const StudyView& view) {
  json settings = json::array();
  for (const study::SettingSummary& summary : view.summaries) settings.push_back(setting_json(view, summary));
  return {{"simulated", view.simulated},   {"preset", view.preset},
          {"label", name_of(view.label)},  {"settings_text", view.settings_text},
          {"epochs", view.epochs},         {"history", view.history},
          {"data_hash", view.data_hash},   {"label_scale_dps", view.label_scale_dps},
          {"folds", view.folds},           {"seeds", view.seeds},
          {"table_seed", view.table_seed}, {"settings", settings},
          {"claims", claims_json(view)}};
}

}  // namespace

std::string study_json(std::span<const study::JobResult> results) {
  json studies = json::array();
  for (const StudyView& view : views_of(results)) studies.push_back(study_of(view));
  return json_text({{"format", "thermorig-study-report"},
                    {"version", 3},
                    {"mse_unit", "(speed / label_scale_dps)^2"},
                    {"paper", paper_json()},
                    {"studies", studies}});
}

}  // namespace thermorig::report
