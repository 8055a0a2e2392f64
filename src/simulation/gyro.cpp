// SPDX-License-Identifier: MIT
#include "gyro.h"

#include <algorithm>
#include <cmath>

#include "thermorig/sensors/wire/device_bytes.h"

namespace thermorig::simulation {
namespace {

constexpr double conversion_shortest_s = 0.0005;
constexpr double conversion_longest_s = 0.0015;
constexpr double conversion_jitter_s = 0.0002;

// A resonator's or RC oscillator's own wander beside its constant error: some 20 ppm in minutes.
constexpr WanderLevel clock_wander{.thermal_amplitude = 15e-6, .walk = 0.4e-6};

// WitMotion: register 0x63, the still time, is 1000 ms by default. A real log goes from a bias of 1.5 deg/s
// to rates of exactly 0.
constexpr std::int64_t still_ns = 1'000'000'000;
constexpr double still_dps = 0.5;

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

Gyro::Gyro(const GyroProfile& profile, GyroGrade grade, std::uint64_t seed, const GyroHabits& habits)
    : quality_(GyroQuality::of(grade)),
      random_(seed, "gyro"),
      axis_(profile.axis),
      sign_(profile.sign),
      nominal_period_us_(1e6 / profile.output_rate_hz),
      period_ns_(1e9 / profile.output_rate_hz / (1.0 + random_.normal(quality_.clock_error))),
      phase_ns_(random_.uniform() * period_ns_),
      wander_(clock_wander, seed, "gyro clock wander"),
      processing_s_(random_.uniform(conversion_shortest_s, conversion_longest_s)),
      scale_(1.0 + random_.normal(quality_.scale_error)),
      temp_c_(random_.uniform(26.0, 34.0)),
      zeroes_itself_(habits.zeroes_itself) {
  processing_s_ = habits.latency_s.value_or(processing_s_);
  for (double& bias : bias_dps_) bias = random_.normal(quality_.bias_dps);
}

std::vector<SimulatedGyroSample> Gyro::follow(const Shaft& shaft) {
  std::vector<SimulatedGyroSample> out;
  if (!started_) {
    started_ = true;
    begin_ = {end_ns(-1), shaft.angle_deg(0)};
  }
  while (true) {
    const std::int64_t time_ns = end_ns(samples_);
    if (time_ns > shaft.known_until_ns()) return out;
    out.push_back(measure({time_ns, shaft.angle_deg(time_ns)}));
    begin_ = out.back().end;
    ++samples_;
  }
}

std::int64_t Gyro::end_ns(std::int64_t sample) {
  return std::llround(wander_.rig_ns(phase_ns_ + static_cast<double>(sample) * period_ns_));
}

/// Clipped and on the grid of counts.
double Gyro::measured_dps(double true_dps, std::size_t axis) {
  const double rate_dps = std::clamp(true_dps + bias_dps_[axis] + random_.normal(quality_.noise_dps),
                                     -quality_.range_dps, quality_.range_dps);
  return quality_.dps_per_count * std::round(rate_dps / quality_.dps_per_count);
}

bool Gyro::is_zeroed(const ShaftMark& end) {
  if (std::abs(mean_rate_dps(begin_, end)) > still_dps) turned_ns_ = end.time_ns;
  return zeroes_itself_ && end.time_ns - turned_ns_ >= still_ns;
}

SimulatedGyroSample Gyro::measure(const ShaftMark& end) {
  SimulatedGyroSample sample{
      .index = static_cast<std::uint64_t>(samples_), .temp_c = temp_c_, .begin = begin_, .end = end};
  sample.device_time_us = std::llround(static_cast<double>(samples_) * nominal_period_us_);
  const double step_dps = quality_.bias_walk_dps * std::sqrt(period_ns_ * 1e-9);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    bias_dps_[axis] += random_.normal(step_dps);
    const bool about_shaft = axis == static_cast<std::size_t>(axis_);
    sample.rate_dps[axis] =
        measured_dps(about_shaft ? sign_ * scale_ * mean_rate_dps(begin_, end) : 0.0, axis);
  }
  if (is_zeroed(end)) sample.rate_dps.fill(0.0);
  const double processing_s = processing_s_ + conversion_jitter_s * random_.uniform();
  sample.ready_ns = end.time_ns + std::llround(processing_s * 1e9);
  return sample;
}

}  // namespace thermorig::simulation
