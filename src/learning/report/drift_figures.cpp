// SPDX-License-Identifier: MIT
#include "drift_figures.h"

#include <cmath>

namespace thermorig::report {

using study::JobResult;

const study::AngleTrack* track_of(const StudyView& view, const std::string& estimator,
                                  const std::string& fold) {
  const JobResult* result = view.job_of(estimator, fold);
  return result != nullptr && !result->evaluation.angles.empty() ? &result->evaluation.angles.front()
                                                                 : nullptr;
}

FoldDrift drift_of(const StudyView& view, const std::string& estimator, const std::string& fold,
                   DriftFrom from) {
  const study::AngleTrack* track = track_of(view, estimator, fold);
  if (track == nullptr) return {};
  if (from == DriftFrom::settled)
    return {track->settled_drift_deg_per_min[estimator], track->settled_worst_deg[estimator]};
  return {track->drift_deg_per_min[estimator], track->worst_deg[estimator]};
}

DriftSummary drift_summary(const StudyView& view, const std::string& estimator, DriftFrom from) {
  std::vector<double> drifts;
  double worst = unknown;
  for (const std::string& fold : view.folds) {
    const FoldDrift drift = drift_of(view, estimator, fold, from);
    if (std::isfinite(drift.deg_per_min)) drifts.push_back(std::abs(drift.deg_per_min));
    worst = std::fmax(worst, drift.worst_deg);
  }
  return {study::spread_of(drifts).median, worst, drifts.size()};
}

double fusion_drift(const StudyView& view, std::uint64_t seed) {
  std::vector<double> drifts;
  for (const JobResult* result : view.jobs(view.reference, true, seed)) {
    if (result->evaluation.angles.empty()) continue;
    const double drift = result->evaluation.angles.front().drift_deg_per_min[study::fusion_name];
    if (std::isfinite(drift)) drifts.push_back(std::abs(drift));
  }
  return study::spread_of(drifts).median;
}

}  // namespace thermorig::report
