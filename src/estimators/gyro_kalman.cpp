// SPDX-License-Identifier: MIT
// A Kalman filter over the gyro's samples: rests show the bias, and between them it wanders. A change of the
// bias also corrects the angle, as far as the error that it had built up is known to the covariance.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "entries.h"
#include "gyro_angle.h"
#include "gyro_rests.h"

namespace thermorig::estimators {

namespace {

constexpr std::array<std::string_view, 2> kalman_values{"bias_dps", "bias_sigma_dps"};
constexpr double steady_acceleration_dps2 = 5.0;  // of a shaft that keeps its speed
constexpr double assumed_noise_dps = 0.1;         // of one sample, until a rest has shown it
constexpr double surprise = 3.0;                  // standard deviations of an innovation: the speed changes
constexpr double known_bias_dps = 0.5;            // an estimate is good once its bias is known so well

/// State: the shaft's angle (deg), what the gyro reads and its bias (deg/s); reading = scale * rate + bias.
/// The scale is not estimated: its uncertainty is added to what is told.
class GyroFilter {
 public:
  explicit GyroFilter(const GyroProfile& gyro) : scale_(gyro.scale), period_s_(1.0 / gyro.output_rate_hz) {
    state_ << 0.0, gyro.bias_dps, gyro.bias_dps;
    covariance_(bias, bias) = gyro.bias_uncertainty_dps * gyro.bias_uncertainty_dps;
  }

  /// What the gyro read a step after the sample before.
  void add(double read_dps, double step_s) {
    predict(step_s);
    const double innovation = read_dps - state_[reading];
    const double variance = covariance_(reading, reading) + noise_dps2_;
    lag_dps2_ += lag_share * (innovation * last_innovation_dps_ - lag_dps2_);
    last_innovation_dps_ = innovation;
    if (innovation * innovation > surprise * surprise * variance) accelerate(innovation / step_s, step_s);
    update(reading, innovation, noise_dps2_);
  }

  /// It read so much, and what was before says nothing of it: at the first sample, or when it begins anew.
  void begin(double read_dps) {
    state_[reading] = read_dps;
    covariance_.row(reading).setZero();
    covariance_.col(reading).setZero();
    covariance_(reading, reading) = noise_dps2_;
  }

  /// The gyro says that nothing turned, and hides its bias.
  void stand(double step_s) {
    covariance_(bias, bias) += bias_walk_dps * bias_walk_dps * step_s;
    begin(state_[bias]);
  }

  /// At rest a gyro reads its bias.
  void learn(const RestBlock& rest) {
    constexpr double share = 0.1;
    noise_dps2_ += share * (rest.noise_variance() - noise_dps2_);
    update(bias, rest.mean_dps() - state_[bias], rest.mean_variance());
  }

  /// Whether so much lies within what is known of the bias.
  bool may_be_bias(double read_dps) const {
    return std::abs(read_dps - state_[bias]) <= surprise * std::hypot(bias_sigma_dps(), 0.01);
  }

  double reading_dps() const { return state_[reading]; }
  double rate_dps() const { return (state_[reading] - state_[bias]) / scale_; }
  double bias_dps() const { return state_[bias]; }
  double bias_sigma_dps() const { return std::sqrt(covariance_(bias, bias)); }
  double noise_variance_dps2() const { return noise_dps2_; }
  double angle_deg() const { return state_[angle]; }
  double angle_variance_deg2() const { return covariance_(angle, angle); }

 private:
  static constexpr int angle = 0, reading = 1, bias = 2;

  void predict(double step_s) {
    Eigen::Matrix3d transition = Eigen::Matrix3d::Identity();
    transition(angle, reading) = step_s / scale_;
    transition(angle, bias) = -step_s / scale_;
    state_ = transition * state_;
    covariance_ = transition * covariance_ * transition.transpose();
    covariance_(bias, bias) += bias_walk_dps * bias_walk_dps * step_s;
    const double unseen = unseen_deg(lost_s(step_s, period_s_));
    covariance_(angle, angle) += unseen * unseen;
    accelerate(steady_acceleration_dps2 * scale_, step_s);
    if (lag_dps2_ > 0.0) accelerate(std::sqrt(lag_dps2_) / step_s, step_s);
  }

  /// Discrete white noise of the acceleration: it is constant over the step (Bar-Shalom, Li and Kirubarajan,
  /// Estimation with Applications to Tracking and Navigation, 6.3.2).
  void accelerate(double acceleration_dps2, double step_s) {
    const Eigen::Vector3d effect(0.5 * step_s * step_s / scale_, step_s, 0.0);
    covariance_ += acceleration_dps2 * acceleration_dps2 * effect * effect.transpose();
  }

  /// One part of the state was measured.
  void update(int part, double innovation, double measurement_variance) {
    const double variance = covariance_(part, part) + measurement_variance;
    const Eigen::Vector3d gain = covariance_.col(part) / variance;
    state_ += gain * innovation;
    covariance_ -= variance * gain * gain.transpose();
  }

  double scale_, period_s_;
  // Innovations that follow each other have nothing in common, unless the filter lags (R. K. Mehra, On the
  // identification of variances and adaptive Kalman filtering, 1970): the mean of their products.
  static constexpr double lag_share = 1.0 / 16.0;
  double lag_dps2_ = 0.0, last_innovation_dps_ = 0.0;
  double noise_dps2_ = assumed_noise_dps * assumed_noise_dps;
  Eigen::Vector3d state_;
  Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Zero();
};

/// What the gyro had turned by, bias included, at each of its last samples.
class TurnHistory {
 public:
  explicit TurnHistory(double period_s) : period_s_(period_s), points_(kept) {}

  void add(HostTime time, double reading_dps) {
    points_[count_ % kept] = has_begun() ? next(time, reading_dps) : Point{time, reading_dps};
    ++count_;
  }

  struct Point {
    HostTime time{};
    double reading_dps = 0.0, turned_deg = 0.0;
    double unseen_deg2 = 0.0;  // variance of what was turned while samples were lost
  };
  const Point& newest() const { return at(count_ - 1); }

  /// At any time; after the newest sample its speed goes on, and before the oldest that is kept its was.
  Point until(HostTime time) const {
    std::size_t after = count_;
    while (after > first() && at(after - 1).time > time) --after;
    if (after == count_) return next(time, newest().reading_dps);
    if (after == first()) return before(at(after), time);
    return between(at(after - 1), at(after), time);
  }

  bool has_begun() const { return count_ > 0; }
  bool reaches_back_to(HostTime time) const {
    return has_begun() && to_s(at(first()).time - time) <= 1.5 * period_s_;
  }
  void clear() { count_ = 0; }

 private:
  static constexpr std::size_t kept = 8192;  // a second of the fastest gyro
  const Point& at(std::size_t place) const { return points_[place % kept]; }
  std::size_t first() const { return count_ > kept ? count_ - kept : 0; }

  Point next(HostTime time, double reading_dps) const {
    const Point& last = newest();
    const double step_s = to_s(time - last.time);
    const double turned_deg = 0.5 * (reading_dps + last.reading_dps) * step_s;
    const double unseen = unseen_deg(lost_s(step_s, period_s_));
    return {time, reading_dps, last.turned_deg + turned_deg, last.unseen_deg2 + unseen * unseen};
  }

  static Point before(const Point& oldest, HostTime time) {
    Point point = oldest;
    point.turned_deg -= oldest.reading_dps * to_s(oldest.time - time);
    return point;
  }

  static Point between(const Point& a, const Point& b, HostTime time) {
    const double share = to_s(time - a.time) / to_s(b.time - a.time);
    return {time, std::lerp(a.reading_dps, b.reading_dps, share),
            std::lerp(a.turned_deg, b.turned_deg, share), std::lerp(a.unseen_deg2, b.unseen_deg2, share)};
  }

  double period_s_;
  std::vector<Point> points_;
  std::size_t count_ = 0;
};

class GyroKalmanEstimator : public Estimator {
 public:
  explicit GyroKalmanEstimator(const Setup& setup)
      : gyro_(setup.gyro),
        period_s_(1.0 / setup.gyro.output_rate_hz),
        filter_(setup.gyro),
        history_(period_s_),
        rates_(setup.frames),
        sigmas_(setup.frames) {}

  std::optional<RateEstimate> add(const Observation& observation) override {
    for (const TimedGyro& sample : observation.gyro) {
      learn(observation, sample);
      follow(sample);
    }
    RateEstimate estimate;
    estimate.values[0] = static_cast<float>(filter_.bias_dps());
    estimate.values[1] = static_cast<float>(filter_.bias_sigma_dps());
    if (history_.has_begun()) tell_angle(observation.frame.exposure_end, estimate);
    tell_rate(observation, estimate);
    return estimate;
  }

 private:
  void follow(const TimedGyro& sample) {
    const HostTime time = sample.stamp.time;
    const double read_dps = sample.rate_dps;
    if (!is_rate(sample.rate_dps) || sample.reading.saturated) return;
    if (history_.has_begun() && time <= history_.newest().time) {
      if (history_.newest().time - time < clock_begins_anew) return;
      history_.clear();
    }
    if (!history_.has_begun())
      filter_.begin(read_dps);
    else if (sample.reading.is_zero())
      filter_.stand(to_s(time - history_.newest().time));
    else
      filter_.add(read_dps, to_s(time - history_.newest().time));
    history_.add(time, filter_.reading_dps());
  }

  /// Of a rest that the servo was told to keep, or of what can be nothing but one.
  void learn(const Observation& observation, const TimedGyro& sample) {
    const bool has_stopped = has_settled(observation, sample.stamp.time);
    if (observation.is_told_to_move || (observation.still_since && !has_stopped)) rests_.interrupt();
    const auto rest = rests_.add(sample);
    if (rest && (has_stopped || filter_.may_be_bias(rest->mean_dps()))) filter_.learn(*rest);
  }

  void tell_rate(const Observation& observation, RateEstimate& estimate) {
    const TimedFrame& frame = observation.frame;
    const bool is_measured = is_rate(observation.gyro_mean_dps) &&
                             frame.exposure_end > frame.exposure_begin &&
                             history_.reaches_back_to(frame.exposure_begin);
    const auto mean = is_measured ? mean_over(frame.exposure_begin, frame.exposure_end) : Mean();
    estimate.rate_dps = rates_.add(mean.rate_dps);
    estimate.rate_sigma_dps = sigmas_.add(mean.sigma_dps);  // most of it is common to all frames
    if (!std::isfinite(estimate.rate_dps))
      estimate.reason = EstimateReason::no_gyro;
    else if (filter_.bias_sigma_dps() > known_bias_dps)
      estimate.reason = EstimateReason::no_rest, estimate.state = EstimateState::starting;
    else
      estimate.state = EstimateState::good;
  }

  struct Mean {
    float rate_dps = RateEstimate::not_known, sigma_dps = RateEstimate::not_known;
  };
  Mean mean_over(HostTime begin, HostTime end) const {
    const TurnHistory::Point from = history_.until(begin), to = history_.until(end);
    const double length_s = to_s(end - begin);
    const double reading_dps = (to.turned_deg - from.turned_deg) / length_s;
    const double rate_dps = (reading_dps - filter_.bias_dps()) / gyro_.scale;
    const double noise_dps2 = filter_.noise_variance_dps2() * period_s_ / length_s;
    const double unseen_dps2 = (to.unseen_deg2 - from.unseen_deg2) / (length_s * length_s);
    const double shift_dps =
        gyro_.link.latency_uncertainty_s * (to.reading_dps - from.reading_dps) / length_s;
    const double sigma_dps =
        std::hypot(std::hypot(filter_.bias_sigma_dps(), std::sqrt(noise_dps2 + unseen_dps2)),
                   gyro_.scale_uncertainty * rate_dps, shift_dps);
    return {static_cast<float>(rate_dps), static_cast<float>(sigma_dps / gyro_.scale)};
  }

  void tell_angle(HostTime now, RateEstimate& estimate) const {
    const double step_s = std::max(0.0, to_s(now - history_.newest().time));
    const double unseen = unseen_deg(lost_s(step_s, period_s_));
    estimate.angle_deg = filter_.angle_deg() + filter_.rate_dps() * step_s;
    const double scale_deg = gyro_.scale_uncertainty / gyro_.scale * estimate.angle_deg;
    const double late_deg = gyro_.link.latency_uncertainty_s * filter_.rate_dps();
    estimate.angle_sigma_deg = static_cast<float>(
        std::hypot(std::sqrt(filter_.angle_variance_deg2()), unseen, std::hypot(scale_deg, late_deg)));
  }

  GyroProfile gyro_;
  double period_s_;
  GyroFilter filter_;
  TurnHistory history_;
  GyroRests rests_;
  WindowRates rates_, sigmas_;
};

}  // namespace

Entry gyro_kalman() {
  return {.name = "gyro-kalman",
          .title = "gyro, Kalman filter of angle, rate and bias",
          .inputs = {.gyro = true, .rest = true},
          .values = kalman_values,
          .make = made<GyroKalmanEstimator>};
}

}  // namespace thermorig::estimators
