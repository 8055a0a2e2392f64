// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "thermorig/estimators/estimator.h"
#include "thermorig/network/estimator.h"
#include "thermorig/network/frames_in_a_row.h"
#include "thermorig/network/last_blocks.h"
#include "thermorig/network/model/model.h"
#include "thermorig/network/scaling.h"

namespace thermorig::estimators {

/// The network of a run, and the images of its window. It looks at each frame once, however many estimators
/// ask: what it says of images, its gate included, does not depend on the gyro (paper eq. 2).
class NetworkWindow {
 public:
  NetworkWindow(const model::Model& model, network::Precision precision);

  /// Takes the frame, the first time that it is shown. Nothing if the window is not complete: fewer than Nf
  /// frames in a row whose pixels are in range, without lost frames or damaged bytes between them.
  const std::optional<network::Output>& look(const Observation& observation);

  EstimateReason reason() const { return reason_; }  // why the last look saw nothing
  const network::Shape& shape() const { return estimator_.shape(); }
  float label_scale_dps() const { return scaling_.label_scale_dps; }

 private:
  network::Estimator estimator_;
  network::Scaling scaling_;
  std::vector<float> prepared_;
  network::LastBlocks images_;
  network::FramesInARow in_a_row_;
  std::optional<std::uint64_t> seen_;
  std::optional<network::Output> output_;
  EstimateReason reason_ = EstimateReason::window_incomplete;
};

}  // namespace thermorig::estimators
