// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "thermorig/core/estimate_row.h"
#include "thermorig/core/measurement.h"
#include "thermorig/estimators/table.h"
#include "thermorig/network/frames_in_a_row.h"
#include "thermorig/network/last_blocks.h"
#include "thermorig/network/window_index.h"

namespace thermorig::live {

/// The estimators of a live run, frame by frame, beside the label of the window that ends with the frame: the
/// mean of the commanded speeds of its frames. Pure and deterministic: the same measurements give the same
/// rows, bit for bit (with kernels of the same instruction set). No call allocates.
///
/// `counted` follows network::WindowRule, as in training: the label, the gyro's mean and the image of every
/// frame of the window are known and sound, and none but the first has lost frames or damaged bytes before
/// it. Where frames stand in for those of a missing camera there is no image to ask for.
class LiveEstimates {
 public:
  explicit LiveEstimates(estimators::Bank bank);

  /// `arrived`: of the chunk that completed the measurement.
  EstimateRow add(const Measurement& measurement, HostTime arrived);

  /// What they have seen and keep beside the rows.
  const estimators::Bank& bank() const { return bank_; }

 private:
  estimators::Bank bank_;
  network::WindowRule rule_;
  network::LastBlocks labels_;
  network::FramesInARow in_a_row_;
};

/// What a recording's header says of them.
std::vector<EstimatorColumn> columns_of(const estimators::Bank& bank);

}  // namespace thermorig::live
