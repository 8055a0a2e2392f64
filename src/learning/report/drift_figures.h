// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "study_view.h"

namespace thermorig::report {

/// How far an integrated estimate goes wrong on one fold.
struct FoldDrift {
  double deg_per_min = unknown;
  double worst_deg = unknown;
};

/// From the first window on, or from AngleTrack::settled_s on.
enum class DriftFrom : std::uint8_t { first, settled };

/// At the reference setting, of StudyView::job_of().
FoldDrift drift_of(const StudyView& view, const std::string& estimator, const std::string& fold,
                   DriftFrom from = DriftFrom::first);

/// The angle track that shows this estimator on a fold, nothing if no job has it.
const study::AngleTrack* track_of(const StudyView& view, const std::string& estimator,
                                  const std::string& fold);

/// Median over folds of |deg/min|, and the largest worst; NaN without folds.
struct DriftSummary {
  double median_deg_per_min = 0.0;
  double worst_deg = 0.0;
  std::size_t folds = 0;
};
DriftSummary drift_summary(const StudyView& view, const std::string& estimator,
                           DriftFrom from = DriftFrom::first);

/// Median |deg/min| over the folds of one seed's fused networks.
double fusion_drift(const StudyView& view, std::uint64_t seed);

}  // namespace thermorig::report
