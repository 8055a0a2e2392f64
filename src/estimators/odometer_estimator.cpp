// SPDX-License-Identifier: MIT
// Heading and rate from gyro, camera and a map of the surroundings: what it does stands in odometer/.
#include "thermorig/estimators/odometer/odometer.h"

#include <array>
#include <cmath>

#include "entries.h"

namespace thermorig::estimators {

namespace {

constexpr std::array<std::string_view, 4> odometer_values{"bias_dps", "scale", "latency_s", "nis"};

class OdometerEstimator : public Estimator {
 public:
  explicit OdometerEstimator(const Setup& setup)
      : odometer_(setup.gyro, setup.camera, setup.map), rates_(setup.frames), sigmas_(setup.frames) {}

  std::optional<RateEstimate> add(const Observation& observation) override {
    const odometer::Report report = odometer_.add(observation.frame, observation.gyro);
    RateEstimate estimate;
    estimate.rate_dps = rates_.add(static_cast<float>(report.rate_dps));
    estimate.rate_sigma_dps = sigmas_.add(static_cast<float>(report.rate_sigma_dps));  // mostly common
    estimate.angle_deg = report.heading_deg;
    estimate.angle_sigma_deg = static_cast<float>(report.heading_sigma_deg);
    estimate.reason = report.reason;
    estimate.state = std::isfinite(estimate.rate_dps) ? report.state : EstimateState::absent;
    estimate.values = {static_cast<float>(report.bias_dps), static_cast<float>(report.scale),
                       static_cast<float>(report.latency_s), static_cast<float>(report.mean_nis)};
    return estimate;
  }

  const odometer::Odometer* odometer() const override { return &odometer_; }

 private:
  odometer::Odometer odometer_;
  WindowRates rates_, sigmas_;
};

}  // namespace

Entry odometer() {
  return {.name = "odometer",
          .title = "gyro and camera against a map of the surroundings",
          .inputs = {.image = true, .gyro = true},
          .keeps_map = true,
          .values = odometer_values,
          .make = made<OdometerEstimator>};
}

}  // namespace thermorig::estimators
