// SPDX-License-Identifier: MIT
// The rate that the images alone tell, without training: what it does stands in likelihood/.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "entries.h"
#include "thermorig/estimators/likelihood/camera_rate.h"

namespace thermorig::estimators {

namespace {

constexpr std::array<std::string_view, 2> likelihood_values{"noise_c", "misfit"};

class ThermalLikelihood : public Estimator {
 public:
  explicit ThermalLikelihood(const Setup& setup)
      : rate_(setup.camera, std::min(setup.frames, likelihood::most_window_frames)),
        rates_(looks(setup)),
        sigmas_(looks(setup)) {}

  std::optional<RateEstimate> add(const Observation& observation) override {
    const likelihood::CameraRateReport report = rate_.add(observation.frame);
    RateEstimate estimate;
    estimate.rate_dps = rates_.add(static_cast<float>(report.rate_dps));
    estimate.rate_sigma_dps = sigmas_.add(static_cast<float>(report.sigma_dps));  // looks share halves
    estimate.values = {static_cast<float>(report.noise_c), static_cast<float>(report.misfit)};
    tell_state(report, estimate);
    integrate(observation.frame, report.window_s, estimate);
    return estimate;
  }

 private:
  /// In a window that is longer than a look.
  static int looks(const Setup& setup) {
    return std::max(1, setup.frames - likelihood::most_window_frames + 1);
  }

  static void tell_state(const likelihood::CameraRateReport& report, RateEstimate& estimate) {
    if (!std::isfinite(estimate.rate_dps)) {
      estimate.reason = report.has_image ? EstimateReason::window_incomplete : EstimateReason::no_image;
    } else if (double{estimate.rate_sigma_dps} < likelihood::told_sigma_dps) {
      estimate.state = EstimateState::good;
    } else {
      estimate.state = EstimateState::not_trusted;
      estimate.reason = EstimateReason::nothing_to_see;
    }
  }

  /// A step a frame. Windows that share halves are wrong together: their errors add up over a window's
  /// length before they begin to cancel.
  void integrate(const TimedFrame& frame, double window_s, RateEstimate& estimate) {
    const double step_s = last_ ? std::max(0.0, to_s(frame.exposure_end - *last_)) : 0.0;
    last_ = frame.exposure_end;
    if (std::isfinite(estimate.rate_dps)) {
      const double sigma_dps = double{estimate.rate_sigma_dps};
      angle_deg_ += double{estimate.rate_dps} * step_s;
      variance_deg2_ += sigma_dps * sigma_dps * step_s * std::max(step_s, window_s);
    } else {
      gap_s_ += step_s;
    }
    estimate.angle_deg = angle_deg_;
    estimate.angle_sigma_deg =
        static_cast<float>(std::hypot(std::sqrt(variance_deg2_), likelihood::any_rate_sigma_dps * gap_s_));
  }

  likelihood::CameraRate rate_;
  WindowRates rates_, sigmas_;
  std::optional<HostTime> last_;
  double angle_deg_ = 0.0, variance_deg2_ = 0.0;
  double gap_s_ = 0.0;  // in which no rate was known
};

}  // namespace

Entry thermal_likelihood() {
  return {.name = "thermal-likelihood",
          .title = "images alone, by their likelihood; no training",
          .inputs = {.image = true},
          .most_frames = likelihood::most_window_frames,
          .values = likelihood_values,
          .make = made<ThermalLikelihood>};
}

}  // namespace thermorig::estimators
