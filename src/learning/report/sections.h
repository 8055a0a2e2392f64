// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>
#include <vector>

#include "document.h"
#include "json_values.h"
#include "study_view.h"

namespace thermorig::report {

// The parts of a study's report, in their order.
Section overview_section(const StudyView& view);
Section frame_sweep_section(const StudyView& view);
Section reduction_sweep_section(const StudyView& view);
Section claims_section(const StudyView& view);
Section seeds_section(const StudyView& view);
Section gate_section(const StudyView& view);
Section angle_section(const StudyView& view);
Section speed_section(const StudyView& view);
Section cost_section(const StudyView& view);
Section training_section(const StudyView& view);
Section folds_section(const StudyView& view);

/// Errors by speed, both directions of a magnitude in one row, of any number of evaluations together.
std::vector<Block> speed_blocks(const std::vector<study::SpeedErrors>& speeds, double label_scale_dps,
                                std::span<const std::string> estimators);

/// Histogram of Kg.
Chart gain_chart(const std::string& title, const study::GainStatistics& gain);

/// Angle errors over integrated time. `tracks`: one an estimator.
struct EstimatorTrack {
  std::string estimator;
  const study::AngleTrack* track;
};
Chart angle_chart(const std::string& title, const std::vector<EstimatorTrack>& tracks);

}  // namespace thermorig::report
