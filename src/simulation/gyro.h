// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "clock_wander.h"
#include "heard.h"
#include "low_pass.h"
#include "random.h"
#include "shaft.h"
#include "thermorig/core/profile.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::simulation {

/// How good a gyro is. Standard deviations are those from one gyro (or one power-up) to the next.
struct GyroQuality {
  double bias_dps;       // standard deviation
  double bias_walk_dps;  // random walk of the bias, a square root of a second
  double scale_error;    // standard deviation, relative
  double noise_dps;      // white, of one sample
  double range_dps;      // readings beyond are clipped
  double dps_per_count;  // resolution
  double clock_error;    // standard deviation, relative

  static GyroQuality of(GyroGrade grade);
};

struct SimulatedGyroSample {
  std::uint64_t index = 0;           // from 0
  std::array<double, 3> rate_dps{};  // x, y, z as measured, clipped and on the grid of counts
  double temp_c = 25.0;
  std::int64_t device_time_us = 0;  // by its own clock, at the end of the interval
  ShaftMark begin;                  // of the averaging interval, earlier by the filter's group delay
  ShaftMark end;
  std::int64_t ready_ns = 0;
};

struct GyroHabits {
  std::optional<double>
      latency_s;               // constant part, from the interval's end to the first byte; drawn if not set
  bool zeroes_itself = false;  // after a second at rest all rates are exactly 0, until it turns again
};

/// A gyro on the shaft, which averages over its sample interval what its low-pass lets through.
class Gyro {
 public:
  Gyro(const GyroProfile& profile, GyroGrade grade, std::uint64_t seed, const GyroHabits& habits = {},
       const GyroWorld& world = {});

  /// The samples whose interval ends by the time up to which the shaft is known.
  std::vector<SimulatedGyroSample> follow(const Shaft& shaft);

 private:
  std::int64_t end_ns(std::int64_t sample);
  const Shaft& felt(const Shaft& shaft);
  double share_of_axis(std::size_t axis, double scale) const;
  SimulatedGyroSample measure(const ShaftMark& end);
  double warming_k(std::int64_t time_ns) const;
  double acceleration_g(const ShaftMark& end) const;
  double noise_dps(double rate_dps, std::size_t axis);
  double measured_dps(double true_dps, double noise_dps, std::size_t axis) const;
  bool is_zeroed(const ShaftMark& end);

  GyroQuality quality_;
  GyroWorld world_;
  Random random_;
  Random vibration_;
  int axis_;
  int sign_;
  double nominal_period_us_;
  double period_ns_;  // true but for the wander
  double phase_ns_;
  ClockWander wander_;
  double processing_s_;
  double scale_;
  double temp_c_;
  std::array<double, 3> bias_dps_{};
  std::int64_t samples_ = 0;
  double zero_below_dps_;       // 0: never
  std::int64_t turned_ns_ = 0;  // when it was last seen to turn
  ShaftMark begin_;             // as the filter lets it through
  bool started_ = false;

  std::optional<LowPass> shaft_filter_;
  std::optional<Shaft> filtered_;
  std::array<std::optional<LowPass>, 3> noise_filters_;
};

/// How the simulated gyro speaks a protocol. It shares no code with what reads it (sensors), but the names.
struct GyroEncoder {
  std::string_view name;
  std::vector<std::uint8_t> (*bytes)(const SimulatedGyroSample& sample, const GyroProfile& profile);
  /// None: it is deaf. `start`: on what it starts to send samples.
  /// `bandwidth_hz`: of its low-pass.
  Heard (*hear)(std::span<const std::uint8_t> bytes, const GyroProfile& profile, GyroStart start,
                double bandwidth_hz) = nullptr;
  /// What it sends in place of a sample before it was asked to send samples. None: nothing.
  std::vector<std::uint8_t> (*idle_bytes)(const SimulatedGyroSample& sample,
                                          const GyroProfile& profile) = nullptr;
};

std::span<const GyroEncoder> gyro_encoders();

/// Of the profile's protocol. Throws Error(bad_usage) if there is none.
const GyroEncoder& gyro_encoder(const GyroProfile& profile);

}  // namespace thermorig::simulation
