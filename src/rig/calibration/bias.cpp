// SPDX-License-Identifier: MIT
#include "rest.h"
#include "thermorig/core/error.h"
#include "thermorig/rig/calibration/calibration.h"

namespace thermorig::calibration {

namespace {

// A bias that walks spreads within a stretch of length T by s * sqrt(T / 6) and moves from the mean of one
// stretch to the mean of the next by s * sqrt(2 T / 3): twice as much.
constexpr double next_stretch = 2.0;

[[noreturn]] void refuse_bias(const std::string& what, const std::string& advice) {
  throw Error(ExitCode::finished_lossy, what, "calibrate bias", advice);
}

}  // namespace

BiasResult measure_bias(const session::Session& session) {
  if (session.sync.gyro.zeroes_itself)
    refuse_bias("this gyro sets itself to zero while it rests, so a rest does not show its bias",
                "switch that off in the gyro's own settings, if it has such; else leave the bias as it is");
  const auto resting = resting_gyro(session.servo, session.gyro);
  if (!resting)
    refuse_bias("the gyro was not at rest for 6 s together",
                "leave the rig alone for the whole minute, on a firm table");
  if (resting->noise_dps == 0.0)
    refuse_bias("the gyro's reading never changes while it rests: it is stuck, or filters itself",
                "check the gyro with `thermorig decode --device gyro`");
  return {.bias_dps = {resting->bias_dps, next_stretch * resting->spread_dps},
          .noise_dps = resting->noise_dps,
          .drift_dps = resting->drift_dps,
          .rest_s = resting->rest_s};
}

}  // namespace thermorig::calibration
