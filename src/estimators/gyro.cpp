// SPDX-License-Identifier: MIT
// The gyro as it is. Its sigma is what the profile says of bias and scale, which a mean over samples does not
// make smaller.
#include <cmath>

#include "entries.h"
#include "gyro_angle.h"

namespace thermorig::estimators {

namespace {

class GyroEstimator : public Estimator {
 public:
  explicit GyroEstimator(const Setup& setup)
      : profile_(setup.gyro), rates_(setup.frames), angle_(1.0 / setup.gyro.output_rate_hz) {}

  std::optional<RateEstimate> add(const Observation& observation) override {
    angle_.add(observation.gyro);
    RateEstimate estimate;
    estimate.rate_dps = rates_.add(observation.gyro_mean_dps);
    if (is_rate(estimate.rate_dps)) {
      estimate.rate_sigma_dps = static_cast<float>(
          std::hypot(sigma(1.0, double{estimate.rate_dps}),
                     mean_shift_dps(angle_.change_dps(), exposure_s(observation.frame), profile_)));
      estimate.state = EstimateState::good;
    } else {
      estimate.rate_dps = RateEstimate::not_known;
      estimate.reason = EstimateReason::no_gyro;
    }
    if (angle_.has_begun()) tell_angle(observation.frame.exposure_end, estimate);
    return estimate;
  }

 private:
  void tell_angle(HostTime time, RateEstimate& estimate) const {
    const GyroAngle::Turn turn = angle_.until(time);
    estimate.angle_deg = turn.angle_deg;
    estimate.angle_sigma_deg =
        static_cast<float>(std::hypot(sigma(turn.elapsed_s, turn.angle_deg), turn.unseen_sigma_deg,
                                      turn.rate_dps * profile_.link.latency_uncertainty_s));
  }

  /// Of a rate, with a duration of 1, or of an angle. `turned`: what the scale is wrong of. The profile's
  /// bias is not removed, so all of it is error.
  double sigma(double duration, double turned) const {
    const double bias_dps = std::hypot(profile_.bias_dps, profile_.bias_uncertainty_dps);
    const double scale = std::hypot(profile_.scale - 1.0, profile_.scale_uncertainty);
    return std::hypot(bias_dps * duration, scale * turned);
  }

  GyroProfile profile_;
  WindowRates rates_;
  GyroAngle angle_;
};

}  // namespace

Entry gyro() {
  return {.name = "gyro",
          .title = "gyro as it is, bias not removed",
          .inputs = {.gyro = true},
          .make = made<GyroEstimator>};
}

}  // namespace thermorig::estimators
