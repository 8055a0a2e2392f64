// SPDX-License-Identifier: MIT
#include "thermorig/simulation/gyro.h"

#include <algorithm>
#include <cmath>

#include "thermorig/wire/device_bytes.h"

namespace thermorig::simulation {
namespace {

constexpr double processing_shortest_s = 0.0005;
constexpr double processing_longest_s = 0.0015;
constexpr double processing_jitter_s = 0.0002;

}  // namespace

GyroQuality GyroQuality::of(GyroGrade grade) {
  // MPU-6050: PS-MPU-6000A-00 rev 3.4 table 6.1 (0.05 deg/s rms, zero rate +-20 deg/s, scale +-3 %), noise as
  // in ten minutes of a real one at rest (0.09 to 0.13 deg/s). WitMotion: counts of 2000/32768 deg/s.
  constexpr double witmotion = wire::witmotion_dps_per_count;
  switch (grade) {
    case GyroGrade::calibrated:
      return {0.1, 0.0005, 0.001, 0.05, 2000.0, witmotion, 50e-6};
    case GyroGrade::typical:
      return {2.0, 0.002, 0.007, 0.07, 2000.0, witmotion, 50e-6};
    case GyroGrade::mpu6050_raw:
      break;
  }
  return {10.0, 0.005, 0.015, 0.11, 250.0, 1.0 / 131.0, 0.005};
}

Gyro::Gyro(const GyroProfile& profile, GyroGrade grade, std::uint64_t seed)
    : quality_(GyroQuality::of(grade)),
      random_(seed, "gyro"),
      axis_(profile.axis),
      sign_(profile.sign),
      nominal_period_us_(1e6 / profile.output_rate_hz),
      period_ns_(1e9 / profile.output_rate_hz / (1.0 + random_.normal(quality_.clock_error))),
      phase_ns_(random_.uniform() * period_ns_),
      processing_s_(random_.uniform(processing_shortest_s, processing_longest_s)),
      scale_(1.0 + random_.normal(quality_.scale_error)),
      temp_c_(random_.uniform(26.0, 34.0)) {
  for (double& bias : bias_dps_) bias = random_.normal(quality_.bias_dps);
}

std::vector<SimulatedGyroSample> Gyro::follow(const Shaft& shaft) {
  std::vector<SimulatedGyroSample> out;
  if (!started_) {
    started_ = true;
    begin_ = {std::llround(phase_ns_ - period_ns_), shaft.angle_deg(0)};
  }
  while (true) {
    const std::int64_t end_ns = std::llround(phase_ns_ + static_cast<double>(samples_) * period_ns_);
    if (end_ns > shaft.known_until_ns()) return out;
    out.push_back(measure({end_ns, shaft.angle_deg(end_ns)}));
    begin_ = out.back().end;
    ++samples_;
  }
}

SimulatedGyroSample Gyro::measure(const ShaftMark& end) {
  SimulatedGyroSample sample{.temp_c = temp_c_, .begin = begin_, .end = end};
  sample.device_time_us = std::llround(static_cast<double>(samples_) * nominal_period_us_);
  const double step_dps = quality_.bias_walk_dps * std::sqrt(period_ns_ * 1e-9);
  for (int axis = 0; axis < 3; ++axis) {
    double& bias_dps = bias_dps_[std::size_t(axis)];
    bias_dps += random_.normal(step_dps);
    const double turning_dps = axis == axis_ ? sign_ * scale_ * mean_rate_dps(begin_, end) : 0.0;
    const double measured_dps = std::clamp(turning_dps + bias_dps + random_.normal(quality_.noise_dps),
                                           -quality_.range_dps, quality_.range_dps);
    sample.rate_dps[std::size_t(axis)] =
        quality_.dps_per_count * std::round(measured_dps / quality_.dps_per_count);
  }
  const double processing_s = processing_s_ + processing_jitter_s * random_.uniform();
  sample.ready_ns = end.time_ns + std::llround(processing_s * 1e9);
  return sample;
}

}  // namespace thermorig::simulation
