// SPDX-License-Identifier: MIT
#pragma once

#include <memory>

#include "thermorig/core/estimate.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"

namespace thermorig::likelihood {

/// What the images of a window tell of the camera's rate about its axis.
struct CameraRateReport {
  bool has_image = false;      // the frame brought a half that is new
  bool is_complete = false;    // so many frames in a row: all that follows is known
  bool is_told = false;        // within told_sigma_dps: there is enough to see
  double rate_dps = unknown;   // over the window's exposures: mean of all rates that may be, by how likely
  double sigma_dps = unknown;  // of it, other rates that may be included
  double window_s = unknown;   // length of those exposures together
  double noise_c = unknown;    // of a reading, as known so far
  double misfit = unknown;     // what no scene at this rate explains, in units of that noise's variance: 1
};

inline constexpr double told_sigma_dps = 20.0;
inline constexpr double fastest_dps = 240.0;
inline constexpr double any_rate_sigma_dps = fastest_dps / 1.7320508075688772;  // each as likely as the other
inline constexpr int most_window_frames = 3;  // a look is at four halves at most

/// The rate of the camera by itself, window by window: the one with which the chess halves agree on one piece
/// of scene, each exposed over its own span. No gyro, no training, no map. Causal and deterministic; after
/// construction nothing is allocated, and the work of a frame is bounded.
class CameraRate {
 public:
  /// `frames`: of a window, 1 to most_window_frames. The pitch of a pixel is that of the field of view.
  CameraRate(const CameraProfile& camera, int frames);
  ~CameraRate();
  CameraRate(CameraRate&&) noexcept;
  CameraRate& operator=(CameraRate&&) noexcept;

  CameraRateReport add(const TimedFrame& frame);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace thermorig::likelihood
