// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <span>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/rate_estimate.h"
#include "thermorig/core/sample.h"
#include "thermorig/estimators/table.h"

namespace thermorig::estimators {

/// How well the rates of a session's windows can be known from their images, as Cramer-Rao bounds against the
/// panorama of the session itself: first all measurements go through bank(), then there are bounds.
class WindowBounds {
 public:
  explicit WindowBounds(const RigProfile& profile);

  /// Its estimates are what take() needs.
  Bank& bank() { return bank_; }

  /// A measurement's frame, and what the bank says of it.
  void take(const TimedFrame& frame, std::span<const RateEstimate> estimates);

  /// Of the windows of so many frames (at least 1) that end with each frame that was taken, deg/s. NaN: not
  /// so many frames in a row, or a panorama without what they show.
  std::vector<float> bounds_dps(int frames) const;

 private:
  struct Seen {
    std::array<HalfExposure, 2> half;
    HostTime end{};
    unsigned newest = 0;       // half
    bool is_new = false;       // it was read anew, and nothing is missing before
    float gyro_dps = 0.0F;     // mean over the exposures
    double heading_deg = 0.0;  // at the end
    bool is_tracked = false;
    float bias_dps = 0.0F, scale = 1.0F;  // of the gyro
    float noise_c = 0.0F;
  };
  std::vector<Seen> with_headings() const;

  CameraProfile camera_;
  Bank bank_;
  std::vector<Seen> seen_;
};

}  // namespace thermorig::estimators
