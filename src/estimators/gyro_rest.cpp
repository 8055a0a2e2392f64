// SPDX-License-Identifier: MIT
// The gyro less the bias that it showed in the opening rest: what most people do.
#include <algorithm>
#include <array>
#include <cmath>

#include "entries.h"
#include "gyro_angle.h"
#include "gyro_rests.h"
#include "thermorig/core/statistics.h"

namespace thermorig::estimators {

namespace {

constexpr std::array<std::string_view, 1> rest_values{"bias_dps"};
constexpr double least_rest_s = 0.5;

class GyroRestEstimator : public Estimator {
 public:
  explicit GyroRestEstimator(const Setup& setup)
      : setup_(setup), rates_(setup.frames), angle_(1.0 / setup.gyro.output_rate_hz) {}

  std::optional<RateEstimate> add(const Observation& observation) override {
    learn(observation);
    angle_.add(observation.gyro);
    const float gyro_dps = rates_.add(observation.gyro_mean_dps);
    RateEstimate estimate;
    if (!is_known()) {
      estimate.reason = EstimateReason::no_rest;
      return estimate;
    }
    const HostTime now = observation.frame.exposure_end;
    estimate.values[0] = static_cast<float>(bias_.mean());
    if (angle_.has_begun()) tell_angle(now, estimate);
    if (!is_rate(gyro_dps)) {
      estimate.reason = EstimateReason::no_gyro;
      return estimate;
    }
    const double rate_dps = double{gyro_dps} - bias_.mean();
    estimate.rate_dps = static_cast<float>(rate_dps);
    estimate.rate_sigma_dps = static_cast<float>(
        std::hypot(bias_sigma_dps(now), scale_error() * rate_dps, mean_sigma_dps(observation.frame)));
    estimate.state = has_moved_ ? EstimateState::good : EstimateState::starting;
    return estimate;
  }

 private:
  bool is_known() const { return rest_s_ >= least_rest_s; }

  /// Only until the rig first moves: what is behind stays removed, be it right or wrong by then.
  void learn(const Observation& observation) {
    if (has_moved_) return;
    if (observation.is_told_to_move) has_moved_ = is_known();
    if (!observation.still_since) rests_.interrupt();
    for (const TimedGyro& sample : observation.gyro) {
      if (!has_settled(observation, sample.stamp.time)) continue;
      if (const auto rest = rests_.add(sample)) learn(*rest, sample.stamp.time);
    }
  }

  void learn(const RestBlock& rest, HostTime now) {
    bias_.add(rest.mean_dps());
    variance_dps2_ += rest.mean_variance();
    rest_s_ += rest.length_s;
    noise_dps2_ = rest.noise_variance();
    known_since_ = now;
  }

  /// For how long the bias has wandered from the mean that was learnt: during the rest it was a third of what
  /// it is after so long (variance).
  double age_s(HostTime now) const { return std::max(0.0, to_s(now - known_since_)) + rest_s_ / 3.0; }

  /// Of the mean of the rest's blocks.
  double rest_noise_dps() const { return std::sqrt(variance_dps2_) / static_cast<double>(bias_.count()); }

  double bias_sigma_dps(HostTime now) const {
    return std::hypot(rest_noise_dps(), bias_walk_dps * std::sqrt(age_s(now)));
  }

  /// Of the mean over a frame's exposure: noise, and where it begins and ends.
  double mean_sigma_dps(const TimedFrame& frame) const {
    const double length_s = exposure_s(frame);
    const double samples = std::max(1.0, length_s * setup_.gyro.output_rate_hz);
    return std::hypot(std::sqrt(noise_dps2_ / samples),
                      mean_shift_dps(angle_.change_dps(), length_s, setup_.gyro));
  }

  double scale_error() const { return std::hypot(setup_.gyro.scale - 1.0, setup_.gyro.scale_uncertainty); }

  void tell_angle(HostTime now, RateEstimate& estimate) const {
    const GyroAngle::Turn turn = angle_.until(now);
    estimate.angle_deg = turn.angle_deg - bias_.mean() * turn.elapsed_s;
    const double age = age_s(now);
    const double wandered_deg =
        bias_walk_dps * std::sqrt(age * age * age / 3.0);  // integral of a random walk
    const double sigma_deg =
        std::hypot(rest_noise_dps() * turn.elapsed_s, wandered_deg, turn.unseen_sigma_deg);
    const double late_deg = setup_.gyro.link.latency_uncertainty_s * turn.rate_dps;
    estimate.angle_sigma_deg =
        static_cast<float>(std::hypot(sigma_deg, scale_error() * estimate.angle_deg, late_deg));
  }

  Setup setup_;
  WindowRates rates_;
  GyroAngle angle_;
  GyroRests rests_;
  RunningStatistics bias_;      // of the means of its blocks
  double variance_dps2_ = 0.0;  // of those means, their sum
  double noise_dps2_ = 0.0;     // variance of a sample
  double rest_s_ = 0.0;
  HostTime known_since_{};
  bool has_moved_ = false;  // after a rest that was long enough
};

}  // namespace

Entry gyro_rest() {
  return {.name = "gyro-rest",
          .title = "gyro, bias of the opening rest removed",
          .inputs = {.gyro = true, .rest = true},
          .values = rest_values,
          .make = made<GyroRestEstimator>};
}

}  // namespace thermorig::estimators
