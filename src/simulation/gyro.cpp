// SPDX-License-Identifier: MIT
#include "gyro.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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

constexpr double unfiltered_hz = 256.0;  // from there on it has no filter
constexpr double turning_dps = 2.0;      // from there on gears are heard
constexpr double leaning_g = 0.087;      // of gravity across a shaft that leans by 5 deg
constexpr double off_axis_m = 0.05;
constexpr double gravity_m_s2 = 9.81;

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

Gyro::Gyro(const GyroProfile& profile, GyroGrade grade, std::uint64_t seed, const GyroHabits& habits,
           const GyroWorld& world)
    : quality_(GyroQuality::of(grade)),
      world_(world),
      random_(seed, "gyro"),
      vibration_(seed, "gyro vibration"),
      axis_(profile.axis),
      sign_(profile.sign),
      nominal_period_us_(1e6 / profile.output_rate_hz),
      period_ns_(1e9 / profile.output_rate_hz / (1.0 + random_.normal(quality_.clock_error))),
      phase_ns_(random_.uniform() * period_ns_),
      wander_(clock_wander, seed, "gyro clock wander"),
      processing_s_(random_.uniform(conversion_shortest_s, conversion_longest_s)),
      scale_(1.0 + random_.normal(quality_.scale_error)),
      temp_c_(random_.uniform(26.0, 34.0)),
      zero_below_dps_(world.zero_below_dps > 0.0 ? world.zero_below_dps
                      : habits.zeroes_itself     ? still_dps
                                                 : 0.0) {
  processing_s_ = habits.latency_s.value_or(processing_s_);
  for (double& bias : bias_dps_) bias = random_.normal(quality_.bias_dps);
  if (world.bandwidth_hz >= unfiltered_hz) return;
  shaft_filter_.emplace(world.bandwidth_hz, 1e-9 * static_cast<double>(Shaft::step_ns));
  if (world.bandwidth_hz < 0.45 * profile.output_rate_hz)
    noise_filters_.fill(LowPass(world.bandwidth_hz, 1.0 / profile.output_rate_hz));
}

/// The shaft as the filter lets it through, up to where it is known.
const Shaft& Gyro::felt(const Shaft& shaft) {
  if (!shaft_filter_) return shaft;
  if (!filtered_) {
    filtered_.emplace(shaft.angle_deg(0));
    shaft_filter_->settle(shaft.angle_deg(0));
  }
  while (filtered_->known_until_ns() < shaft.known_until_ns())
    filtered_->append(shaft_filter_->next(shaft.angle_deg(filtered_->known_until_ns() + Shaft::step_ns)));
  return *filtered_;
}

std::vector<SimulatedGyroSample> Gyro::follow(const Shaft& shaft) {
  std::vector<SimulatedGyroSample> out;
  const Shaft& seen = felt(shaft);
  if (!started_) {
    started_ = true;
    begin_ = {end_ns(-1), seen.angle_deg(0)};
  }
  const std::int64_t delay_ns = shaft_filter_ ? std::llround(1e9 * shaft_filter_->delay_s()) : 0;
  const auto shown = [&](std::int64_t time_ns) {
    return ShaftMark{time_ns - delay_ns, shaft.angle_deg(time_ns - delay_ns)};
  };
  while (true) {
    const std::int64_t time_ns = end_ns(samples_);
    if (time_ns > shaft.known_until_ns()) return out;
    const ShaftMark end{time_ns, seen.angle_deg(time_ns)};
    out.push_back(measure(end));
    out.back().begin = shown(begin_.time_ns);
    out.back().end = shown(time_ns);
    begin_ = end;
    ++samples_;
  }
}

std::int64_t Gyro::end_ns(std::int64_t sample) {
  return std::llround(wander_.rig_ns(phase_ns_ + static_cast<double>(sample) * period_ns_));
}

/// Its temperature against that of a warm one.
double Gyro::warming_k(std::int64_t time_ns) const {
  return -world_.self_heating_k * std::exp(-1e-9 * static_cast<double>(time_ns) / world_.self_heating_s);
}

/// Along its axis: gravity as the shaft turns in it, and what turning does to a gyro that is off the axis.
double Gyro::acceleration_g(const ShaftMark& end) const {
  const double to_rad = std::numbers::pi / 180.0;
  const double rate_rad = to_rad * mean_rate_dps(begin_, end);
  return leaning_g * std::cos(to_rad * end.angle_deg) + off_axis_m * rate_rad * rate_rad / gravity_m_s2;
}

/// White before the filter.
double Gyro::noise_dps(double rate_dps, std::size_t axis) {
  double noise_dps = random_.normal(quality_.noise_dps);
  if (world_.vibration_dps > 0.0 && std::abs(rate_dps) > turning_dps)
    noise_dps += vibration_.normal(world_.vibration_dps);
  return noise_filters_[axis] ? noise_filters_[axis]->next(noise_dps) : noise_dps;
}

/// Clipped and on the grid of counts.
double Gyro::measured_dps(double true_dps, double noise_dps, std::size_t axis) const {
  const double rate_dps =
      std::clamp(true_dps + bias_dps_[axis] + noise_dps, -quality_.range_dps, quality_.range_dps);
  return quality_.dps_per_count * std::round(rate_dps / quality_.dps_per_count);
}

bool Gyro::is_zeroed(const ShaftMark& end) {
  if (std::abs(mean_rate_dps(begin_, end)) > zero_below_dps_) turned_ns_ = end.time_ns;
  return zero_below_dps_ > 0.0 && end.time_ns - turned_ns_ >= still_ns;
}

/// Of the shaft's rate. A gyro that is mounted otherwise shows a part of it about the next axis.
double Gyro::share_of_axis(std::size_t axis, double scale) const {
  const double mounted_rad = std::numbers::pi / 180.0 * world_.mounted_deg;
  const auto own = static_cast<std::size_t>(axis_);
  if (axis == own) return sign_ * scale * std::cos(mounted_rad);
  const double leaned = axis == (own + 1) % 3 ? sign_ * scale * std::sin(mounted_rad) : 0.0;
  return world_.cross_axis + leaned;
}

SimulatedGyroSample Gyro::measure(const ShaftMark& end) {
  const double warming = warming_k(end.time_ns);
  SimulatedGyroSample sample{.index = static_cast<std::uint64_t>(samples_), .temp_c = temp_c_ + warming};
  sample.device_time_us = std::llround(static_cast<double>(samples_) * nominal_period_us_);
  const double step_dps = quality_.bias_walk_dps * std::sqrt(period_ns_ * 1e-9);
  const double rate_dps = mean_rate_dps(begin_, end);
  const double scale = scale_ * (1.0 + world_.scale_change + world_.scale_per_k * warming);
  const double extra_dps = world_.bias_per_k_dps * warming + world_.g_sensitivity_dps * acceleration_g(end);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    bias_dps_[axis] += random_.normal(step_dps);
    const double seen_dps = share_of_axis(axis, scale) * rate_dps;
    sample.rate_dps[axis] = world_.unit * measured_dps(seen_dps + extra_dps, noise_dps(rate_dps, axis), axis);
  }
  if (is_zeroed(end)) sample.rate_dps.fill(0.0);
  const double processing_s = processing_s_ + conversion_jitter_s * random_.uniform();
  sample.ready_ns = end.time_ns + std::llround(processing_s * 1e9);
  return sample;
}

}  // namespace thermorig::simulation
