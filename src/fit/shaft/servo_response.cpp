// SPDX-License-Identifier: MIT
#include "thermorig/fit/shaft/servo_response.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "gain_fit.h"
#include "gyro_integral.h"
#include "loop_fit.h"
#include "reached_speeds.h"
#include "shaft_curve.h"
#include "thermorig/core/statistics.h"
#include "thermorig/fit/shaft/intervals.h"
#include "thermorig/pipeline/labels/gyro_track.h"
#include "thermorig/pipeline/labels/label_config.h"
#include "thermorig/pipeline/labels/pulse_train.h"
#include "thermorig/pipeline/labels/servo_model.h"
#include "thermorig/pipeline/labels/shaft_track.h"

namespace thermorig::fit {

using labels::pulse_period_s, labels::ShaftTrack, labels::LabelConfig;

namespace {
constexpr double least_delay_error_s = 3e-4;
constexpr double shortest_frame_s = 1.0 / 64.0;  // the camera's fastest rate
constexpr double longest_frame_s = 2.0;          // and its slowest
constexpr double shaft_reach_s = 2.0;            // before a frame: its low-pass, and telemetry's period
constexpr double rest_from_knot_s = 17.0;        // half a stretch of the bias's course, and the way there

/// Shaft angle per commanded angle: what the profile says, and what the gyro says as far as its own scale is
/// known. No weight depends on the ratio: a gyro that shows a fiftieth would be fifty times as certain.
Estimate absolute_scale(const Estimate& ratio, const GyroErrors& errors, const ServoProfile& profile,
                        Witness outlier) {
  const double gyro_share = errors.scale.uncertainty / std::max(errors.scale.value, 1e-3);
  const Estimate by_gyro{ratio.value, std::hypot(ratio.uncertainty, profile.scale * gyro_share, 1e-6)};
  if (outlier == Witness::command) return by_gyro;
  const Estimate by_profile{profile.scale, std::max(profile.scale_uncertainty, 1e-6)};
  return weighted_mean(std::array{by_gyro, by_profile});
}

/// Who says how fast the shaft turns is not known: so is its scale.
void widen_scale(const Witnesses& witnesses, ServoResponse& response) {
  if (witnesses.outlier != Witness::undecided) return;
  const auto off = [&](const std::optional<Estimate>& share) {
    return share ? share->value - response.scale.value : 0.0;
  };
  response.scale.uncertainty =
      std::hypot(response.scale.uncertainty, off(witnesses.gyro_share), off(witnesses.images_share));
}

/// Collects residuals of one commanded speed.
struct Residuals {
  double sum = 0.0, squares = 0.0;
  double hidden_squares = 0.0;  // of what the gyro's low-pass hides of the model, so that nothing confirms it
  double noise_squares = 0.0;   // of the gyro's means over one pulse period
  std::uint32_t count = 0, noise_count = 0;
  void add(double residual, double hidden) {
    sum += residual;
    squares += residual * residual;
    hidden_squares += hidden * hidden;
    ++count;
  }
};

/// What the gyro's means over one pulse period differ by from the middle of their neighbours: too fast for a
/// shaft with a load, so it is noise. `near`: see first_after().
void note_noise(const GyroIntegral& gyro, double begin_s, double end_s, std::size_t& near,
                Residuals& residuals) {
  double before = unknown, last = unknown;
  for (double from_s = begin_s; from_s + pulse_period_s <= end_s; from_s += pulse_period_s) {
    const double mean_dps = gyro.mean_dps(from_s, from_s + pulse_period_s, near);
    const double square = labels::alternation_dps2(before, last, mean_dps);
    before = last;
    last = mean_dps;
    if (!std::isfinite(square)) continue;
    residuals.noise_squares += square;
    ++residuals.noise_count;
  }
}

/// The shaft as labels have it (ShaftTrack), as the corrected gyro should see it.
class FittedShaft {
 public:
  /// `reach_s`: how far before the latest time that was asked for one may ask.
  FittedShaft(std::span<const TimedServo> servo, HostTime origin, const ServoProfile& profile,
              const ServoResponse& response, double reach_s, double longest_gap_s)
      : left_(servo),
        origin_(origin),
        track_(profile, as_the_gyro_sees(response), from_s(longest_gap_s), from_s(reach_s)) {}

  double mean_dps(double begin_s, double end_s) {
    const HostTime begin = origin_ + from_s(begin_s), end = origin_ + from_s(end_s);
    for (; !left_.empty() && !track_.reaches(end); left_ = left_.subspan(1)) track_.add(left_.front());
    return track_.mean_dps(begin, end);
  }

  /// Whether it turns as commanded until `end_s`, which mean_dps() was asked for: no frame is valid where
  /// telemetry that came late has it jerk.
  bool is_even(double begin_s, double end_s, double rate_dps) const {
    const double turned_deg =
        track_.at(origin_ + from_s(end_s)).plain_deg - track_.at(origin_ + from_s(begin_s)).plain_deg;
    const LabelConfig config;
    const double tolerance_dps =
        std::max(config.rate_tolerance_dps, config.rate_tolerance_share * std::abs(rate_dps));
    return std::abs(turned_deg / (end_s - begin_s) - rate_dps) <= tolerance_dps;
  }

 private:
  static ServoResponse as_the_gyro_sees(ServoResponse response) {
    response.scale = response.gyro_ratio;
    return response;
  }

  std::span<const TimedServo> left_;  // not in the track yet
  HostTime origin_;
  ShaftTrack track_;
};

std::map<long long, Residuals> residuals_of(const std::vector<Interval>& intervals, FittedShaft& shaft,
                                            const GyroIntegral& gyro, const LowPass& low_pass,
                                            const GainFit& gain, double settle, double frame_s) {
  std::map<long long, Residuals> by_speed;  // by centidegrees per second
  std::size_t near_gyro = 0;
  for (const Interval& interval : intervals) {
    if (interval.leg == 0) continue;  // on the way to a start: nobody planned that speed
    for (double from_s = interval.begin_s + settle; from_s + frame_s <= interval.end_s; from_s += frame_s) {
      const double rate_dps = gyro.mean_dps(from_s, from_s + frame_s, near_gyro) - gain.bias_at(from_s);
      if (!std::isfinite(rate_dps)) continue;
      const auto mean = [&](double begin_s, double end_s) { return shaft.mean_dps(begin_s, end_s); };
      const double shown_dps = low_pass.shown_dps(from_s, from_s + frame_s, mean);
      const double model_dps = mean(from_s, from_s + frame_s);
      if (!shaft.is_even(from_s, from_s + frame_s, interval.rate_dps)) continue;
      Residuals& residuals = by_speed[std::llround(100.0 * interval.rate_dps)];
      residuals.add(rate_dps - shown_dps, model_dps - shown_dps);
      note_noise(gyro, from_s, from_s + frame_s, near_gyro, residuals);
    }
  }
  return by_speed;
}

void note_reached(const std::vector<ReachedSpeed>& reached, ServoResponse& response) {
  for (const ReachedSpeed& speed : reached)
    response.speeds.push_back({.rate_dps = speed.rate_dps,
                               .residual_dps = unknown,
                               .spread_dps = unknown,
                               .reached_dps = speed.reached_dps,
                               .contradicts = speed.contradicts});
}

/// A row for every speed of the legs, with what the gyro shows of it, if anything.
void note_all_contradict(const std::vector<Interval>& legs, const std::vector<ReachedSpeed>& reached,
                         ServoResponse& response) {
  std::map<double, double> shown;
  for (const Interval& leg : legs)
    if (leg.leg != 0) shown[leg.rate_dps] = unknown;
  for (const ReachedSpeed& speed : reached) shown[speed.rate_dps] = speed.reached_dps;
  for (const auto& [rate_dps, reached_dps] : shown)
    response.speeds.push_back({.rate_dps = rate_dps,
                               .residual_dps = unknown,
                               .spread_dps = unknown,
                               .reached_dps = reached_dps,
                               .contradicts = true});
}

/// The row of that speed, which is added if there is none.
ServoResponse::AtSpeed& at_speed(double rate_dps, ServoResponse& response) {
  auto& speeds = response.speeds;
  const auto next = std::find_if(speeds.begin(), speeds.end(), [&](const auto& speed) {
    return speed.rate_dps > rate_dps - constant_dps / 2.0;
  });
  if (next != speeds.end() && next->rate_dps < rate_dps + constant_dps / 2.0) return *next;
  return *speeds.insert(next, {.rate_dps = rate_dps});
}

/// Before the first knot and after the last one lie the rests, if there were any.
void note_bias_course(const GainFit& gain, HostTime origin, GyroErrors& errors) {
  errors.bias_course.clear();
  if (gain.bias_course.empty()) return;
  const double removed_dps = errors.bias_dps ? errors.bias_dps->value : 0.0;
  const auto add = [&](double time_s, double bias_dps) {
    errors.bias_course.push_back({origin + from_s(time_s), bias_dps});
  };
  if (errors.bias_before_dps) add(gain.bias_course.front().first - rest_from_knot_s, *errors.bias_before_dps);
  for (const auto& [time_s, left_dps] : gain.bias_course)
    add(time_s, removed_dps + errors.scale.value * (gain.bias_dps + left_dps));
  if (errors.bias_after_dps) add(gain.bias_course.back().first + rest_from_knot_s, *errors.bias_after_dps);
}

/// Of `count` residuals; it is not known better than chance lets know it.
double spread_without_noise_dps(double spread_dps2, double noise_dps2, double count) {
  return std::sqrt(std::max(spread_dps2 - noise_dps2, spread_dps2 * std::sqrt(2.0 / count)));
}

/// `period_s`: of the gyro's samples.
void note_residuals(ServoResponse& response, const std::map<long long, Residuals>& by_speed, double frame_s,
                    double period_s) {
  double squares = 0.0, count = 0.0;
  for (const auto& [centi_dps, residuals] : by_speed) {
    const double n = residuals.count;
    const double mean = residuals.sum / n;
    ServoResponse::AtSpeed& speed = at_speed(0.01 * static_cast<double>(centi_dps), response);
    speed.residual_dps = mean;
    const double noise_dps2 =
        residuals.noise_count > 0 ? residuals.noise_squares / residuals.noise_count : 0.0;
    speed.noise_dps = std::sqrt(noise_dps2 * pulse_period_s / period_s);
    const double spread_dps = spread_without_noise_dps(std::max(0.0, residuals.squares / n - mean * mean),
                                                       noise_dps2 * pulse_period_s / frame_s, n);
    speed.spread_dps = std::hypot(spread_dps, std::sqrt(residuals.hidden_squares / n));
    speed.frames = residuals.count;
    if (speed.contradicts) continue;
    squares += residuals.squares;
    count += n;
  }
  std::erase_if(response.speeds, [](const auto& speed) { return speed.frames == 0 && !speed.contradicts; });
  if (count > 0.0) response.residual_dps = std::sqrt(squares / count);
}

float median_clock_uncertainty_s(std::span<const TimedGyro> gyro) {
  std::vector<double> values;
  values.reserve(gyro.size());
  for (const TimedGyro& sample : gyro) values.push_back(static_cast<double>(sample.stamp.uncertainty_s));
  return static_cast<float>(median(std::move(values)));
}
}  // namespace

namespace {
ServoResponse fitted_response(std::span<const TimedServo> servo, std::span<const TimedGyro> gyro,
                              GyroErrors& errors, const ServoProfile& profile, double frame_period_s,
                              const Witnesses& witnesses, double longest_gap_s) {
  ServoResponse response = labels::assumed_response(profile);
  if (servo.empty() || gyro.empty() || errors.decay_per_s > 0.0) return response;
  const HostTime origin = servo.front().stamp.time;
  const PulseScale scale(profile);
  const GyroIntegral integral(gyro, errors, origin);
  const std::vector<PulseAt> pulses = all_pulses(servo, scale, origin, longest_gap_s);
  if (pulses.empty() || integral.period_s() <= 0.0) return response;
  const double bias_uncertainty_dps = errors.bias_dps ? errors.bias_dps->uncertainty : unknown_bias_dps;
  const std::vector<Interval> legs = steady_intervals(servo, origin, false);
  std::vector<ReachedSpeed> reached = reached_speeds(legs, integral, bias_uncertainty_dps, profile.kind);
  const Witness outlier = witnesses.outlier;
  if (outlier == Witness::gyro || outlier == Witness::undecided) {
    note_all_contradict(legs, reached, response);
    widen_scale(witnesses, response);
    return response;
  }
  note_reached(reached, response);
  const std::vector<Interval> strayed = strayed_intervals(legs, reached);
  std::vector<Interval> changes = speed_changes(servo, origin, longest_gap_s);
  std::erase_if(changes, [&](const Interval& change) {
    return is_within(strayed, change.begin_s) || is_within(strayed, change.end_s);
  });
  const auto loop = fit_loop(pulses, changes, integral, errors.filter_delay_s.value, profile,
                             !servo.back().state.is_measured);
  if (!loop) return response;
  const double end_s = pulses.back().end_s;
  const ShaftCurve curve(pulses, scale.continuous(), loop->loop_hz, loop->dead_band_deg, end_s);
  const ShaftEvidence evidence{curve,  pulses.front().end_s, end_s, loop->delay_s.value, scale, integral,
                               strayed};
  const auto gain = fit_gain_and_ripples(evidence, bias_uncertainty_dps);
  if (!gain) return response;
  response.fitted = true;
  response.delay_s = loop->delay_s.value;
  response.delay_uncertainty_s =
      std::hypot(loop->delay_s.uncertainty, median_clock_uncertainty_s(gyro), least_delay_error_s);
  response.loop_hz = loop->loop_hz;
  response.dead_band_deg = loop->dead_band_deg;
  response.gyro_ratio = gain->ratio;
  response.gain = gain->gain;
  response.ripples = gain->ripples;
  response.scale = absolute_scale(gain->ratio, errors, profile, outlier);
  response.scale_calibrated = response.scale_calibrated || errors.scale_calibrated;
  note_bias_course(*gain, origin, errors);
  const double frame_s = std::clamp(frame_period_s, shortest_frame_s, longest_frame_s);
  FittedShaft shaft(servo, origin, profile, response, frame_s + shaft_reach_s, longest_gap_s);
  const LowPass low_pass(errors.filter_delay_s.value);
  note_residuals(response,
                 residuals_of(legs, shaft, integral, low_pass, *gain, labels::settle_s(response), frame_s),
                 frame_s, integral.period_s());
  return response;
}

}  // namespace

ServoResponse fit_servo_response(std::span<const TimedServo> servo, std::span<const TimedGyro> gyro,
                                 GyroErrors& errors, const ServoProfile& profile, double frame_period_s,
                                 const Witnesses& witnesses, double longest_gap_s) {
  ServoResponse response =
      fitted_response(servo, gyro, errors, profile, frame_period_s, witnesses, longest_gap_s);
  if (witnesses.outlier == Witness::command)
    for (ServoResponse::AtSpeed& speed : response.speeds) speed.contradicts = true;
  return response;
}

}  // namespace thermorig::fit
