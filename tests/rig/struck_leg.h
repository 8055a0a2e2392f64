// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "simulated_bus.h"
#include "thermorig/rig/recording/port_recording.h"
#include "virtual_ports.h"

namespace thermorig::rig::test {

constexpr double rest_dps = 1.0;
constexpr double moving_dps = 20.0;

/// The quick plan with 90 deg/s alone: two legs of so many frames.
inline SweepPlan two_legs(int frames) {
  PlanOverrides overrides;
  overrides.magnitudes_dps = {90.0};
  overrides.frames_per_leg = frames;
  overrides.valid_per_leg = 0;
  overrides.opening_rest_s = overrides.closing_rest_s = 0.3;
  return load_plan("quick", "garden", 1, overrides);
}

/// A rig whose recording is struck in the first of two legs of five seconds.
class StruckLeg {
 protected:
  explicit StruckLeg(const simulation::VirtualRigConfig& config)
      : ports_(config, simulation::make_servo(config)) {
    options_.recording = recording_options(folder_, config.profile, two_legs(40));
    for (const Device device : all_devices)
      options_.recording.profile.link(device).port = ports_.paths()[device];
    options_.progress_period = std::chrono::milliseconds(50);
  }

  /// Records, has `mishap` strike in the first leg, and lets the rig go on for a second.
  RecordingResult suffer(const std::function<void()>& mishap) {
    options_.progress = [this, mishap](const RecordingProgress& progress) {
      if (struck_ || progress.sweep.phase != SweepPhase::leg || progress.sweep.frames < 4) return;
      struck_ = ports_.now();
      mishap();
    };
    RecordingResult result;
    try {
      result = record_ports(options_, ports_);
    } catch (const Error& error) {
      result.exit = error.code();
    }
    ports_.let_pass(std::chrono::seconds(1));
    return result;
  }

  double fastest_dps(HostTime from, HostTime until) {
    double fastest = 0.0;
    for (const simulation::TruthSample& sample : ports_.rig().shaft())
      if (sample.time >= from && sample.time <= until) fastest = std::max(fastest, std::abs(sample.rate_dps));
    return fastest;
  }

  TemporaryFolder folder_;
  VirtualPorts ports_;
  PortOptions options_;
  std::optional<HostTime> struck_;
};

}  // namespace thermorig::rig::test
