// SPDX-License-Identifier: MIT
// The estimates of the paper's network: its thermal head alone, and what its gate makes of that and the gyro
// (paper eq. 2). Where its gate states a sigma of the first, the images are also fused with a gyro whose bias
// is followed, each by its sigma.
#include "network_estimators.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "entries.h"
#include "thermorig/network/gate.h"
#include "thermorig/network/trainer.h"
#include "thermorig/network/turn.h"

namespace thermorig::estimators {

namespace {

constexpr std::array<std::string_view, 1> fusion_values{"gain"};  // Kg, of the gate
constexpr std::array<std::string_view, 1> kalman_fusion_values{"image_weight"};

/// A network from a stranger's file may say anything.
float finite_or_unknown(float value) {
  return std::isfinite(value) ? value : RateEstimate::not_known;
}

void mirror_rows(std::span<const float, frame_pixels> from, std::span<float, frame_pixels> mirrored) {
  for (std::size_t row = 0; row < frame_pixels; row += frame_columns)
    std::reverse_copy(from.begin() + row, from.begin() + row + frame_columns, mirrored.begin() + row);
}

/// Speed over time, a step a frame; from where the first speed is known.
class AngleOfFrames {
 public:
  double add(float rate_dps, HostTime time) {
    const double step_s = last_ ? std::max(0.0, to_s(time - *last_)) : 0.0;
    last_ = time;
    if (std::isfinite(rate_dps)) angle_deg_ += double{rate_dps} * step_s;
    return angle_deg_;
  }

 private:
  std::optional<HostTime> last_;
  double angle_deg_ = 0.0;
};

/// What the network's estimators have in common: its window, a gyro that is heard at every frame, an angle.
class NetworkEstimator : public Estimator {
 public:
  explicit NetworkEstimator(const Setup& setup) : network_(setup.network) {}

  std::optional<RateEstimate> add(const Observation& observation) final {
    const auto& output = network_->look(observation);
    const bool has_gyro = hear(observation);
    RateEstimate estimate;
    if (!output)
      estimate.reason = network_->reason();
    else if (!has_gyro)
      estimate.reason = EstimateReason::no_gyro;
    else
      fill(*output, estimate);
    if (std::isfinite(estimate.rate_dps)) estimate.state = EstimateState::good;
    estimate.angle_deg = angle_.add(estimate.rate_dps, observation.frame.exposure_end);
    return estimate;
  }

 protected:
  const NetworkWindow& network() const { return *network_; }

 private:
  /// False where the gyro says nothing of this window.
  virtual bool hear(const Observation& observation) = 0;
  /// The rate, its sigma, and the values.
  virtual void fill(const network::Output& output, RateEstimate& estimate) const = 0;

  std::shared_ptr<NetworkWindow> network_;
  AngleOfFrames angle_;
};

class ThermalEstimator : public NetworkEstimator {
 public:
  using NetworkEstimator::NetworkEstimator;

 private:
  bool hear(const Observation&) override { return true; }
  void fill(const network::Output& output, RateEstimate& estimate) const override {
    estimate.rate_dps = finite_or_unknown(output.thermal * network().speed_scale_dps());
    estimate.rate_sigma_dps = network().sigma_dps(output.gain);
  }
};

class FusionEstimator : public NetworkEstimator {
 public:
  explicit FusionEstimator(const Setup& setup) : NetworkEstimator(setup), rates_(setup.frames) {}

 private:
  bool hear(const Observation& observation) override {
    gyro_dps_ = rates_.add(observation.gyro_mean_dps);
    return is_rate(gyro_dps_);
  }
  void fill(const network::Output& output, RateEstimate& estimate) const override {
    const float scale_dps = network().speed_scale_dps();
    estimate.rate_dps = finite_or_unknown(network::fusion_of(output, gyro_dps_ / scale_dps) * scale_dps);
    estimate.values[0] = finite_or_unknown(output.gain);
  }

  WindowRates rates_;
  float gyro_dps_ = RateEstimate::not_known;  // mean over the window
};

/// Where a rest has shown the gyro's bias, the images get only the weight that is left to them; before, the
/// profile says how far off the bias may be. The gyro's scale gives them no weight: their own errors over a
/// whole room are as large.
class KalmanFusionEstimator : public NetworkEstimator {
 public:
  explicit KalmanFusionEstimator(const Setup& setup)
      : NetworkEstimator(setup), filter_(gyro_kalman().make(setup)) {}

 private:
  bool hear(const Observation& observation) override {
    gyro_ = filter_->add(observation).value_or(RateEstimate{});
    return std::isfinite(gyro_.rate_dps);
  }
  void fill(const network::Output& output, RateEstimate& estimate) const override {
    const double thermal_dps = double{output.thermal * network().speed_scale_dps()};
    const double thermal_sigma_dps = double{network().sigma_dps(output.gain)};
    const double gain = network::gain_beside(double{gyro_.values[1]}, thermal_sigma_dps);
    const double rate_dps = gain * thermal_dps + (1.0 - gain) * double{gyro_.rate_dps};
    const double sigma_dps =
        std::hypot(gain * thermal_sigma_dps, (1.0 - gain) * double{gyro_.rate_sigma_dps});
    estimate.rate_dps = finite_or_unknown(static_cast<float>(rate_dps));
    estimate.rate_sigma_dps = finite_or_unknown(static_cast<float>(sigma_dps));
    estimate.values[0] = finite_or_unknown(static_cast<float>(gain));
  }

  std::unique_ptr<Estimator> filter_;
  RateEstimate gyro_;
};

}  // namespace

void FramePeriod::add(HostTime exposure_end, bool follows) {
  if (follows && last_) {
    sum_s_ += to_s(exposure_end - *last_);
    count_ += 1.0;
  }
  last_ = exposure_end;
}

NetworkWindow::NetworkWindow(const model::Model& model, NetworkRun run, const CameraProfile& camera)
    : estimator_(model.weights, run.precision),
      scaling_(model.scaling),
      turned_(run.turned),
      is_mirror_image_(model.provenance.view && model.provenance.view->mirrored != camera.mirrored),
      prepared_(shape().pixels()),
      turned_window_(shape().inputs()),
      images_(static_cast<std::size_t>(shape().frames), shape().pixels()),
      window_(shape().inputs()),
      period_(1.0 / camera.output_rate_hz),
      in_a_row_(shape().frames) {}

const std::optional<network::Output>& NetworkWindow::look(const Observation& observation) {
  if (seen_ == observation.index) return output_;
  seen_ = observation.index;
  const TimedFrame& frame = observation.frame;
  const int in_a_row = in_a_row_.push(frame);
  period_.add(frame.exposure_end, in_a_row > 1);
  if (is_mirror_image_) mirror_rows(frame.frame.temp_c, mirrored_);
  network::prepare_frame(is_mirror_image_ ? mirrored_ : frame.frame.temp_c, shape(), scaling_, prepared_);
  images_.push(prepared_);
  output_.reset();
  reason_ = in_a_row > 0 ? EstimateReason::window_incomplete : EstimateReason::no_image;
  if (in_a_row == shape().frames) output_ = estimate();
  return output_;
}

network::Output NetworkWindow::estimate() {
  if (!scaling_.by_window) return estimator_.estimate(images_.all(), 0.0F);
  std::copy_n(images_.all().data(), window_.size(), window_.data());
  network::scale_window(window_, shape());
  if (turned_ == 1) return estimator_.estimate(window_, 0.0F);
  network::TurnedOutputs outputs;
  for (std::uint8_t bits = 0; bits < network::Turn::all; ++bits) {
    const network::Turn turn(bits);
    network::turn_window(window_, shape(), turn, turned_window_);
    outputs.add(estimator_.estimate(turned_window_, 0.0F), turn, shape().fusion);
  }
  return outputs.mean(0.0F, shape().fusion);
}

float NetworkWindow::sigma_dps(float gain) const {
  if (!scaling_.gate_states_sigma) return RateEstimate::not_known;
  return static_cast<float>(network::gate_sigma(double{gain}, network::gate_gyro_sigma)) * speed_scale_dps();
}

Entry cnn_thermal() {
  return {.name = "cnn-thermal",
          .title = "thermal head of the network",
          .inputs = {.image = true},
          .needs_network = true,
          .make = made<ThermalEstimator>};
}

Entry cnn_fusion() {
  return {.name = "cnn-fusion",
          .title = "network's fusion of camera and gyro",
          .inputs = {.image = true, .gyro = true},
          .needs_network = true,
          .needs_fusion = true,
          .values = fusion_values,
          .make = made<FusionEstimator>};
}

Entry cnn_fusion_kalman() {
  return {.name = "cnn-fusion-kalman",
          .title = "camera and gyro-kalman, weighed by their sigmas",
          .inputs = {.image = true, .gyro = true, .rest = true},
          .needs_network = true,
          .needs_fusion = true,
          .needs_sigma = true,
          .values = kalman_fusion_values,
          .make = made<KalmanFusionEstimator>};
}

}  // namespace thermorig::estimators
