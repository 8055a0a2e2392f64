// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "gain_statistics.h"
#include "thermorig/core/statistics.h"
#include "thermorig/learning/study/study.h"

namespace thermorig::study {

namespace {

/// All that the folds of one row have in common, in the order of the rows.
auto row_key(const Job& job) {
  return std::tuple(job.frames, job.reduction, job.fusion, job.seed, job.preset, job.epochs, job.history,
                    job.engine, job.settings, job.data_hash);
}

using Folds = std::vector<const JobResult*>;

void add_errors(SettingSummary& summary, const Folds& folds, double label_scale_dps) {
  for (const std::string& name : all_estimators()) {
    for (const JobResult* fold : folds) summary.fold_mse[name].push_back(fold->evaluation.errors[name].mse);
    summary.mse[name] = spread_of(summary.fold_mse[name]);
    summary.rmse_dps[name] = std::sqrt(summary.mse[name].median) * label_scale_dps;
  }
}

SettingSummary summary_of(const Folds& folds) {
  const JobResult& first = *folds.front();
  SettingSummary summary;
  summary.frames = first.job.frames;
  summary.reduction = first.job.reduction;
  summary.fusion = first.job.fusion;
  summary.seed = first.job.seed;
  summary.preset = first.job.preset;
  summary.epochs = first.job.epochs;
  summary.folds = folds.size();
  summary.weights = first.weights;
  summary.multiply_adds = first.multiply_adds;
  add_errors(summary, folds, first.label_scale_dps);
  std::vector<GainStatistics> gains;
  for (const JobResult* fold : folds) gains.push_back(fold->evaluation.gain);
  summary.gain = merged(gains);
  return summary;
}

}  // namespace

Spread spread_of(std::vector<double> values) {
  std::erase_if(values, [](double value) { return std::isnan(value); });
  std::sort(values.begin(), values.end());
  return {quantile(values, 0.5), quantile(values, 0.75) - quantile(values, 0.25)};
}

std::vector<SettingSummary> summarise(std::span<const JobResult> results) {
  std::map<decltype(row_key(Job{})), Folds> rows;
  for (const JobResult& result : results) rows[row_key(result.job)].push_back(&result);
  std::vector<SettingSummary> summaries;
  for (auto& [key, folds] : rows) {
    std::sort(folds.begin(), folds.end(),
              [](const JobResult* a, const JobResult* b) { return a->job.test < b->job.test; });
    summaries.push_back(summary_of(folds));
  }
  return summaries;
}

}  // namespace thermorig::study
