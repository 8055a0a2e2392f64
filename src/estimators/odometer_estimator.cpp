// SPDX-License-Identifier: MIT
// Heading and rate from gyro, camera and a map of the surroundings: what it does stands in odometer/.
#include "thermorig/estimators/odometer/odometer.h"

#include <array>
#include <cmath>
#include <utility>

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
    estimate.rate_sigma_dps =
        sigmas_.add(static_cast<float>(report.rate_sigma_dps));  // most is common to all
    estimate.angle_deg = report.heading_deg;
    estimate.angle_sigma_deg = static_cast<float>(report.heading_sigma_deg);
    estimate.reason = report.reason;
    estimate.state = std::isfinite(estimate.rate_dps) ? report.state : EstimateState::absent;
    rows_ = {report.rows, report.row_margin};
    estimate.values = {static_cast<float>(report.bias_dps), static_cast<float>(report.scale),
                       static_cast<float>(report.latency_s), static_cast<float>(report.mean_nis)};
    return estimate;
  }

  std::optional<Surroundings> surroundings() const override {
    std::vector<float> image_c = odometer_.map_image_c();
    if (image_c.empty()) return std::nullopt;
    return Surroundings{std::move(image_c)};
  }

  std::optional<odometer::Map> map() const override { return odometer_.map(); }
  odometer::MapUse map_use() const override { return odometer_.map_use(); }
  std::optional<odometer::FoundRows> rows() const override {
    return rows_.margin > 0.0 ? std::optional(rows_) : std::nullopt;
  }

 private:
  odometer::Odometer odometer_;
  WindowRates rates_, sigmas_;
  odometer::FoundRows rows_;  // a margin of 0: not compared yet
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
