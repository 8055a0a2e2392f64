// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

namespace thermorig {

/// How far an estimate can be trusted.
enum class EstimateState : std::uint8_t {
  absent,    // it says nothing: see the reason
  starting,  // it says something, and still learns what its sigma needs
  good,
  relocalising,  // it knows its surroundings, and searches where in them it looks
  not_trusted    // it says something, and knows that it may be wrong: see the reason
};
inline constexpr std::array<std::string_view, 5> estimate_state_names{"absent", "starting", "good",
                                                                      "relocalising", "not_trusted"};

/// Why an estimate is not good.
enum class EstimateReason : std::uint8_t {
  none,
  window_incomplete,  // fewer frames in a row than it looks at
  no_image,           // no camera, or a pixel that is out of range
  no_gyro,            // no gyro sample in the exposure of a frame that it looks at
  no_rest,            // the rig has not been at rest yet, for as long as it needs
  gyro_frozen,        // its samples repeat each other bit by bit
  view_differs,       // what the camera shows does not fit the surroundings as they were
  nothing_to_see      // a wall without structure: images of it fit any rate
};
inline constexpr std::array<std::string_view, 8> estimate_reason_names{
    "none",    "window_incomplete", "no_image",     "no_gyro",
    "no_rest", "gyro_frozen",       "view_differs", "nothing_to_see"};

constexpr std::string_view name_of(EstimateState state) {
  return estimate_state_names[static_cast<std::size_t>(state)];
}
constexpr std::string_view name_of(EstimateReason reason) {
  return estimate_reason_names[static_cast<std::size_t>(reason)];
}

inline constexpr std::size_t most_estimate_values = 4;

/// What an estimator says of the motion about the servo's axis when a frame has come. NaN: not known.
struct RateEstimate {
  static constexpr float not_known = std::numeric_limits<float>::quiet_NaN();

  float rate_dps = not_known;        // mean over the exposures of the run's window, which ends with the frame
  float rate_sigma_dps = not_known;  // one standard deviation, as the estimator states it; NaN: not stated
  double angle_deg = not_known;      // since the estimator's own origin, at the end of the frame's exposure
  float angle_sigma_deg = not_known;
  EstimateState state = EstimateState::absent;
  EstimateReason reason = EstimateReason::none;
  std::array<float, most_estimate_values> values{not_known, not_known, not_known, not_known};  // by name
};

/// Of an estimator that stated nothing else: good where the rate is known.
inline RateEstimate rate_only(float rate_dps) {
  RateEstimate estimate;
  estimate.rate_dps = rate_dps;
  estimate.state = std::isfinite(rate_dps) ? EstimateState::good : EstimateState::absent;
  return estimate;
}

}  // namespace thermorig
