// SPDX-License-Identifier: MIT
// The gyro less the bias that it showed in the opening rest: what most people do.
#include <array>
#include <cmath>

#include "entries.h"
#include "gyro_angle.h"
#include "window_rates.h"

namespace thermorig::estimators {

namespace {

constexpr std::array<std::string_view, 1> rest_values{"bias_dps"};
constexpr double least_rest_s = 1.0;
constexpr HostDuration settling = std::chrono::milliseconds(500);  // of shaft and gyro after a stop
constexpr double wander_dps = 0.05;  // that a bias moves by within minutes: acceptance of a consumer gyro

/// Mean and spread of samples, one by one.
class RunningMean {
 public:
  void add(double value) {
    ++count_;
    const double off = value - mean_;
    mean_ += off / static_cast<double>(count_);
    squares_ += off * (value - mean_);
  }

  std::size_t count() const { return count_; }
  double mean() const { return mean_; }
  double uncertainty() const {
    const auto count = static_cast<double>(count_);
    return count_ < 2 ? 0.0 : std::sqrt(squares_ / (count - 1.0) / count);
  }

 private:
  std::size_t count_ = 0;
  double mean_ = 0.0, squares_ = 0.0;
};

class GyroRestEstimator : public Estimator {
 public:
  explicit GyroRestEstimator(const Setup& setup) : setup_(setup), rates_(setup.frames) {}

  std::optional<RateEstimate> add(const Observation& observation) override {
    learn(observation);
    angle_.add(observation.gyro);
    const float gyro_dps = rates_.add(observation.gyro_mean_dps);
    RateEstimate estimate;
    if (!is_known()) {
      estimate.reason = EstimateReason::no_rest;
      return estimate;
    }
    estimate.values[0] = static_cast<float>(bias_.mean());
    if (angle_.has_begun()) {
      estimate.angle_deg = angle_.turned_deg() - bias_.mean() * angle_.elapsed_s();
      estimate.angle_sigma_deg = sigma(angle_.elapsed_s(), angle_.path_deg());
    }
    if (!std::isfinite(gyro_dps)) {
      estimate.reason = EstimateReason::no_gyro;
      return estimate;
    }
    estimate.rate_dps = static_cast<float>(double{gyro_dps} - bias_.mean());
    estimate.rate_sigma_dps = sigma(1.0, double{estimate.rate_dps});
    estimate.state = has_moved_ ? EstimateState::good : EstimateState::starting;
    return estimate;
  }

  void reset() override { *this = GyroRestEstimator(setup_); }

 private:
  bool is_known() const { return rest_s_ >= least_rest_s; }

  /// Only until the rig first moves: what is behind stays removed, be it right or wrong by then.
  void learn(const Observation& observation) {
    if (has_moved_) return;
    if (!observation.still_since) {
      has_moved_ = is_known();
      return;
    }
    for (const TimedGyro& sample : observation.gyro) {
      const HostTime time = sample.stamp.time;
      if (time < *observation.still_since + settling || !std::isfinite(sample.rate_dps)) continue;
      bias_.add(double{sample.rate_dps});
      if (!first_) first_ = time;
      rest_s_ = to_s(time - *first_);
    }
  }

  float sigma(double duration, double turned) const {
    const double scale = std::hypot(setup_.gyro.scale - 1.0, setup_.gyro.scale_uncertainty);
    return static_cast<float>(
        std::hypot(std::hypot(bias_.uncertainty(), wander_dps) * duration, scale * turned));
  }

  Setup setup_;
  WindowRates rates_;
  GyroAngle angle_;
  RunningMean bias_;
  std::optional<HostTime> first_;
  double rest_s_ = 0.0;
  bool has_moved_ = false;  // after a rest that was long enough
};

}  // namespace

Entry gyro_rest() {
  return {.name = "gyro-rest",
          .title = "gyro, bias of the opening rest removed",
          .inputs = {.gyro = true, .rest = true},
          .values = rest_values,
          .make = [](const Setup& setup) -> std::unique_ptr<Estimator> {
            return std::make_unique<GyroRestEstimator>(setup);
          }};
}

}  // namespace thermorig::estimators
