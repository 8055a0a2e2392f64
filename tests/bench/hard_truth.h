// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "thermorig/core/device.h"
#include "thermorig/simulation/virtual_rig.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::bench {

/// Labels of a session against the shaft, over the frames within legs whose bytes are those of a frame that
/// the camera sent.
struct LabelErrors {
  std::size_t frames = 0;               // within legs
  std::size_t useless = 0;              // of these: repeats, or the shaft's true speed is not steady in them
  std::size_t rejected_useless = 0;     // of those: not valid
  std::vector<double> shaft_dps;        // of valid frames: rate_shaft minus the truth; NaN: no label
  std::vector<double> uncertainty_dps;  // of the same frames, one standard deviation, as stated
  std::vector<double> commanded_dps;    // of the same frames: rate_commanded minus the truth
  std::vector<double> commanded_uncertainty_dps;
  std::vector<double> corrected_dps;  // rate_corrected minus the truth
  std::vector<double> corrected_uncertainty_dps;
};
LabelErrors label_errors(const session::Session& session, const simulation::VirtualRig& rig);

/// Times of one stream of a session against the truth: the end of a frame's exposure, the middle of a gyro
/// sample's interval, the instant at which the servo's clock read what its telemetry says. Frames that the
/// session itself calls late or stale are left out: it claims nothing of their times.
struct TimeErrors {
  std::vector<double> errors_s;  // stated minus true
  std::vector<double> widths_s;  // between the stated bounds
  std::size_t outside = 0;       // of these, beyond the stated bounds and three deviations of the latency
};
PerDevice<TimeErrors> time_errors(const session::Session& session, const simulation::VirtualRig& rig);

/// What the gyro really made of the shaft's turning in this session: slope of its rates against the truth, in
/// means over a second.
/// For whoever looks into a session; nothing is judged by it. None: it did not turn.
std::optional<double> true_gyro_scale(const session::Session& session, const simulation::VirtualRig& rig);

/// Whether `truth` lies outside what `stamp` allows, bounds on either side widened by `more_s` seconds.
bool is_outside(const Stamp& stamp, HostTime truth, double more_s);

/// Times of the servo's messages as a live run has them, and how wide their bounds are in the median.
struct LiveServoTimes {
  TimeErrors errors;
  double median_width_s = 0.0;
};
LiveServoTimes live_servo_times(const session::Session& session, const simulation::VirtualRig& rig);

}  // namespace thermorig::bench
