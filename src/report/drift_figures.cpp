// SPDX-License-Identifier: MIT
#include "drift_figures.h"

#include <cmath>

namespace thermorig::report {
namespace {

using study::Estimator;
using study::JobResult;

double median_or_nan(const std::vector<double>& values) {
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : study::spread_of(values).median;
}

}  // namespace

const JobResult* track_of(const StudyView& view, Estimator estimator, const std::string& fold) {
  const bool fusion_first = estimator != Estimator::thermal;
  const JobResult* result = view.job(view.reference, fusion_first, fold);
  const bool either = estimator == Estimator::gyro || estimator == Estimator::gyro_unbiased;
  if (result == nullptr && either) result = view.job(view.reference, !fusion_first, fold);
  return result != nullptr && !result->evaluation.angles.empty() ? result : nullptr;
}

FoldDrift drift_of(const StudyView& view, Estimator estimator, const std::string& fold) {
  const JobResult* result = track_of(view, estimator, fold);
  if (result == nullptr) return {};
  const study::AngleTrack& track = result->evaluation.angles.front();
  const auto index = static_cast<std::size_t>(estimator);
  return {track.drift_deg_per_min[index], track.worst_deg[index]};
}

DriftSummary drift_summary(const StudyView& view, Estimator estimator) {
  std::vector<double> drifts;
  double worst = std::numeric_limits<double>::quiet_NaN();
  for (const std::string& fold : view.folds) {
    const FoldDrift drift = drift_of(view, estimator, fold);
    if (std::isfinite(drift.deg_per_min)) drifts.push_back(std::abs(drift.deg_per_min));
    worst = std::fmax(worst, drift.worst_deg);
  }
  return {median_or_nan(drifts), worst, drifts.size()};
}

double fusion_drift(const StudyView& view, std::uint64_t seed) {
  std::vector<double> drifts;
  for (const JobResult* result : view.jobs(view.reference, true, seed)) {
    if (result->evaluation.angles.empty()) continue;
    const double drift =
        result->evaluation.angles.front().drift_deg_per_min[static_cast<std::size_t>(Estimator::fusion)];
    if (std::isfinite(drift)) drifts.push_back(std::abs(drift));
  }
  return median_or_nan(drifts);
}

}  // namespace thermorig::report
