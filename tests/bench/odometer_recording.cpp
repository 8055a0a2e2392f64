// SPDX-License-Identifier: MIT
#include "odometer_recording.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "thermorig/pipeline/replay.h"

namespace thermorig::bench {
namespace {

/// The legs of the plan one after the other, as often as the time allows.
std::vector<Leg> legs_of(const rig::SweepPlan& plan, double camera_rate_hz, double duration_s) {
  const double leg_s = plan.frames_per_leg / camera_rate_hz;
  std::vector<Leg> legs;
  double at_s = plan.opening_rest_s;
  do {
    for (const double rate_dps : plan.leg_rates_dps) {
      if (duration_s > 0.0 && at_s + leg_s + plan.closing_rest_s > duration_s) return legs;
      legs.push_back({at_s, leg_s, rate_dps});
      at_s += leg_s;
    }
  } while (duration_s > 0.0);
  return legs;
}

}  // namespace

simulation::VirtualRigConfig rig_of(const OdometerCase& wanted) {
  simulation::VirtualRigConfig config = simulation::default_rig(wanted.seed, wanted.environment);
  config.start = bench_start();
  config.gyro_grade = wanted.gyro_grade;
  simulation::put_in_world(simulation::world_named(wanted.world, wanted.seed), config);
  config.profile.camera.field_of_view_deg = wanted.field_of_view_deg;
  config.profile.camera.output_rate_hz = wanted.camera_rate_hz;
  return config;
}

Recorded drive(const OdometerCase& wanted, const rig::SweepPlan& plan) {
  const std::vector<Leg> legs = legs_of(plan, wanted.camera_rate_hz, wanted.duration_s);
  const double end_s = legs.back().begin_s + legs.back().duration_s + plan.closing_rest_s;
  return record(rig_of(wanted), legs, end_s);
}

OdometerRecording record(const OdometerCase& wanted) {
  const rig::SweepPlan plan = rig::load_plan(wanted.plan, wanted.environment, wanted.seed);
  Recorded recorded = drive(wanted, plan);
  if (wanted.calibrated) recorded.raw.header.profile = *wanted.calibrated;
  OdometerRecording recording;
  recording.profile = recorded.raw.header.profile;
  recording.shaft = recorded.rig->shaft();
  pipeline::CausalReplay replay(recorded.raw);
  while (auto moment = replay.next())
    std::move(moment->measurements.begin(), moment->measurements.end(),
              std::back_inserter(recording.measurements));
  recording.first_leg_s = plan.opening_rest_s;
  return recording;
}

double shaft_deg(const OdometerRecording& recording, HostTime time) {
  const auto& shaft = recording.shaft;
  const auto later = std::partition_point(
      shaft.begin(), shaft.end(), [time](const simulation::TruthSample& one) { return one.time <= time; });
  if (later == shaft.begin()) return shaft.front().angle_deg;
  if (later == shaft.end()) return shaft.back().angle_deg;
  const auto& before = *std::prev(later);
  return std::lerp(before.angle_deg, later->angle_deg,
                   to_s(time - before.time) / to_s(later->time - before.time));
}

}  // namespace thermorig::bench
