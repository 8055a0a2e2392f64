// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "thermorig/core/estimate_row.h"
#include "thermorig/core/measurement.h"
#include "thermorig/estimators/table.h"

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
  ~LiveEstimates();
  LiveEstimates(LiveEstimates&&) noexcept;
  LiveEstimates& operator=(LiveEstimates&&) noexcept;

  /// `arrived`: of the chunk that completed the measurement.
  EstimateRow add(const Measurement& measurement, HostTime arrived);

  /// What the estimator at that place of the rows has seen of the surroundings. Allocates.
  std::optional<estimators::Surroundings> surroundings(std::size_t place) const;

  /// The map that an estimator keeps, for a later run, and what has become of the one that it began with.
  std::optional<odometer::Map> map() const;
  odometer::MapUse map_use() const;

  /// In which order the camera exposes its rows, as that estimator has found it.
  std::optional<odometer::FoundRows> rows() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// What a recording's header says of them.
std::vector<EstimatorColumn> columns_of(const estimators::Bank& bank);

}  // namespace thermorig::live
