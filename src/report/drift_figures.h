// SPDX-License-Identifier: MIT
#pragma once

#include <limits>

#include "study_view.h"

namespace thermorig::report {

/// How far an integrated estimate goes wrong on one fold.
struct FoldDrift {
  double deg_per_min = std::numeric_limits<double>::quiet_NaN();
  double worst_deg = std::numeric_limits<double>::quiet_NaN();
};

/// At the reference setting. Thermal-only's is of the thermal-only network, fusion's of the fused one, the
/// gyro's of either.
FoldDrift drift_of(const StudyView& view, study::Estimator estimator, const std::string& fold);

/// The result whose angle track shows this estimator on a fold, nothing if no job has it.
const study::JobResult* track_of(const StudyView& view, study::Estimator estimator, const std::string& fold);

/// Median over folds of |deg/min|, and the largest worst; NaN without folds.
struct DriftSummary {
  double median_deg_per_min = 0.0;
  double worst_deg = 0.0;
  std::size_t folds = 0;
};
DriftSummary drift_summary(const StudyView& view, study::Estimator estimator);

/// Median |deg/min| over the folds of one seed's fused networks.
double fusion_drift(const StudyView& view, std::uint64_t seed);

}  // namespace thermorig::report
