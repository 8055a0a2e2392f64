// SPDX-License-Identifier: MIT
// The gyro as it is. Its sigma is what the profile says of bias and scale, which a mean over samples does not
// make smaller.
#include <cmath>

#include "entries.h"
#include "gyro_angle.h"
#include "window_rates.h"

namespace thermorig::estimators {

namespace {

class GyroEstimator : public Estimator {
 public:
  explicit GyroEstimator(const Setup& setup) : profile_(setup.gyro), rates_(setup.frames) {}

  std::optional<RateEstimate> add(const Observation& observation) override {
    angle_.add(observation.gyro);
    RateEstimate estimate;
    estimate.rate_dps = rates_.add(observation.gyro_mean_dps);
    if (std::isfinite(estimate.rate_dps)) {
      estimate.rate_sigma_dps = sigma(1.0, double{estimate.rate_dps});
      estimate.state = EstimateState::good;
    } else {
      estimate.reason = EstimateReason::no_gyro;
    }
    if (angle_.has_begun()) {
      estimate.angle_deg = angle_.turned_deg();
      estimate.angle_sigma_deg = sigma(angle_.elapsed_s(), angle_.path_deg());
    }
    return estimate;
  }

  void reset() override {
    rates_.reset();
    angle_ = {};
  }

 private:
  /// Of a rate, with a duration of 1, or of an angle. `turned`: what the scale is wrong of. The profile's
  /// bias is not removed, so all of it is error.
  float sigma(double duration, double turned) const {
    const double bias_dps = std::hypot(profile_.bias_dps, profile_.bias_uncertainty_dps);
    const double scale = std::hypot(profile_.scale - 1.0, profile_.scale_uncertainty);
    return static_cast<float>(std::hypot(bias_dps * duration, scale * turned));
  }

  GyroProfile profile_;
  WindowRates rates_;
  GyroAngle angle_;
};

}  // namespace

Entry gyro() {
  return {.name = "gyro",
          .title = "gyro as it is",
          .inputs = {.gyro = true},
          .make = [](const Setup& setup) -> std::unique_ptr<Estimator> {
            return std::make_unique<GyroEstimator>(setup);
          }};
}

}  // namespace thermorig::estimators
