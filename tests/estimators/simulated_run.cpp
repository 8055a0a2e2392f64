// SPDX-License-Identifier: MIT
#include "simulated_run.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "simulation/gyro.h"
#include "thermorig/pipeline/pipeline.h"

namespace thermorig::estimators {

simulation::VirtualRigConfig rig_of(std::uint64_t seed, simulation::GyroGrade grade, ServoKind servo) {
  simulation::VirtualRigConfig config = simulation::default_rig(seed, "laboratory");
  const auto quality = simulation::GyroQuality::of(grade);
  config.gyro_grade = grade;
  config.profile.gyro.scale_uncertainty = quality.scale_error;
  config.profile.gyro.bias_uncertainty_dps = quality.bias_dps;
  config.profile.servo.kind = servo;
  if (servo == ServoKind::continuous) {
    config.profile.servo.travel_deg = 0.0;
    config.profile.servo.full_rate_dps = 300.0;
  }
  return config;
}

std::vector<pipeline::SweepLeg> six_legs() {
  return {{5.0, 6.0, 60.0},    {13.0, 6.0, -150.0}, {21.0, 6.0, 20.0},
          {29.0, 6.0, -100.0}, {37.0, 6.0, 180.0},  {45.0, 6.0, -40.0}};
}

std::vector<Measurement> measurements_of(const pipeline::VirtualSweep& sweep) {
  pipeline::Pipeline pipeline(sweep.config.profile);
  std::vector<Measurement> all;
  const auto take = [&](std::vector<Measurement> some) {
    std::move(some.begin(), some.end(), std::back_inserter(all));
  };
  std::size_t next = 0;
  for (const Chunk& chunk : sweep.chunks) {
    for (; next < sweep.sent.chunk_count() && sweep.sent.time(next) <= chunk.arrived; ++next)
      pipeline.sent(Device::servo, sweep.sent.chunk(next), sweep.sent.time(next));
    take(pipeline.feed(chunk.device, chunk.bytes, chunk.arrived));
  }
  take(pipeline.finish());
  return all;
}

double ShaftTruth::angle_deg(HostTime time) const {
  const auto later = std::partition_point(
      shaft_.begin(), shaft_.end(), [time](const simulation::TruthSample& one) { return one.time <= time; });
  if (later == shaft_.begin()) return shaft_.front().angle_deg;
  if (later == shaft_.end()) return shaft_.back().angle_deg;
  const auto& before = *std::prev(later);
  const double share = to_s(time - before.time) / to_s(later->time - before.time);
  return std::lerp(before.angle_deg, later->angle_deg, share);
}

}  // namespace thermorig::estimators
