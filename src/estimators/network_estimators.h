// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/estimators/estimator.h"
#include "thermorig/estimators/table.h"
#include "thermorig/network/estimator.h"
#include "thermorig/network/frames_in_a_row.h"
#include "thermorig/network/last_blocks.h"
#include "thermorig/network/model/model.h"
#include "thermorig/network/scaling.h"

namespace thermorig::estimators {

/// Mean time between frames that follow each other. Begins with what the camera was set to, which counts as
/// much as 16 frames.
class FramePeriod {
 public:
  explicit FramePeriod(double nominal_s) : sum_s_(frames_of_nominal * nominal_s) {}
  /// The next frame; `follows`: none is missing before it.
  void add(HostTime exposure_end, bool follows);
  double seconds() const { return sum_s_ / count_; }

 private:
  static constexpr double frames_of_nominal = 16.0;
  double sum_s_, count_ = frames_of_nominal;
  std::optional<HostTime> last_;
};

/// The network of a run, and the images of its window. It looks at each frame once, however many estimators
/// ask: what it says of images, its gate included, does not depend on the gyro (paper eq. 2).
class NetworkWindow {
 public:
  NetworkWindow(const model::Model& model, NetworkRun run, const CameraProfile& camera);

  /// Takes the frame, the first time that it is shown. Nothing if the window is not complete: fewer than Nf
  /// frames in a row whose pixels are in range, without lost frames or damaged bytes between them.
  const std::optional<network::Output>& look(const Observation& observation);

  EstimateReason reason() const { return reason_; }  // why the last look saw nothing
  const network::Shape& shape() const { return estimator_.shape(); }
  /// What the gate states of the speed from the images, one standard deviation; NaN: it states none.
  float sigma_dps(float gain) const;
  /// Deg/s that the network calls 1, at the pace of the frames so far.
  float speed_scale_dps() const { return scaling_.speed_scale_dps(period_.seconds()); }

 private:
  network::Output estimate();

  network::Estimator estimator_;
  network::Scaling scaling_;
  int turned_;
  bool is_mirror_image_;  // the camera sends mirror images of what the network has learnt
  std::array<float, frame_pixels> mirrored_{};
  std::vector<float> prepared_, turned_window_;
  network::LastBlocks images_;  // as prepare_frame() makes them
  std::vector<float> window_;
  FramePeriod period_;
  network::FramesInARow in_a_row_;
  std::optional<std::uint64_t> seen_;
  std::optional<network::Output> output_;
  EstimateReason reason_ = EstimateReason::window_incomplete;
};

}  // namespace thermorig::estimators
