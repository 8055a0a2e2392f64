// SPDX-License-Identifier: MIT
#include "thermorig/fit/shaft/encoder_fit.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "gyro_integral.h"
#include "thermorig/core/statistics.h"
#include "thermorig/fit/shaft/intervals.h"

namespace thermorig::fit {

namespace {

constexpr double after_ramp_s = 0.4;       // until a shaft follows a change of speed
constexpr double slowest_leg_dps = 30.0;   // below it errors of the gyro that repeat with a turn count
constexpr double shortest_leg_deg = 60.0;  // of less, nothing is to be seen of what repeats with a turn
constexpr std::size_t fewest_legs = 4;
constexpr double fewest_turns = 1.5;
constexpr double least_error_deg = 0.01;  // what repeats three times and more
constexpr double still_share = 0.2;       // a sensor that turns by less does not turn with the shaft
constexpr double moved_deg = 0.1;         // no magnet that was left alone has other errors by so much
constexpr double share_window_s = 0.5;

using Four = Eigen::Vector4d;

Four harmonics_at(double sent_deg) {
  const double phase = sent_deg * std::numbers::pi / 180.0;
  return {std::cos(phase), std::sin(phase), std::cos(2.0 * phase), std::sin(2.0 * phase)};
}

/// A reading within a leg: what was sent, turns counted, against the gyro.
struct LegPoint {
  double time_s, sent_deg, gyro_deg;
};
using LegPoints = std::vector<LegPoint>;

std::vector<LegPoints> points_of_legs(std::span<const TimedShaft> shaft, std::span<const TimedServo> servo,
                                      const GyroIntegral& gyro, HostTime origin) {
  std::vector<LegPoints> legs;
  auto reading = shaft.begin();
  std::size_t near = 0;
  for (const Interval& interval : steady_intervals(servo, origin, false)) {
    if (interval.leg == 0 || std::abs(interval.rate_dps) < slowest_leg_dps) continue;
    const double begin_s = interval.begin_s + after_ramp_s;
    LegPoints points;
    for (; reading != shaft.end() && to_s(reading->stamp.time - origin) < interval.end_s; ++reading) {
      const double time_s = to_s(reading->stamp.time - origin);
      if (time_s <= begin_s || !has_angle(reading->reading)) continue;
      if (reading->lost_before && !points.empty()) break;
      double sent_deg = reading->reading.angle_deg;
      const double turn_deg = reading->reading.turn_deg;
      if (!points.empty() && turn_deg > 0.0)
        sent_deg += turn_deg * std::round((points.back().sent_deg - sent_deg) / turn_deg);
      const double gyro_deg = gyro.mean_dps(begin_s, time_s, near) * (time_s - begin_s);
      if (std::isfinite(gyro_deg)) points.push_back({time_s - begin_s, sent_deg, gyro_deg});
    }
    if (points.size() < 20 || std::abs(points.back().gyro_deg - points.front().gyro_deg) < shortest_leg_deg)
      continue;
    legs.push_back(std::move(points));
  }
  return legs;
}

/// Least squares over legs, of which each has an offset and a rate of its own.
struct HarmonicSums {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Four right = Four::Zero();

  void add(const LegPoints& points, double sign) {
    const auto rows = static_cast<Eigen::Index>(points.size());
    Eigen::Matrix<double, Eigen::Dynamic, 5> columns(rows, 5);
    Eigen::Matrix<double, Eigen::Dynamic, 2> own(rows, 2);
    for (Eigen::Index i = 0; i < rows; ++i) {
      const LegPoint& point = points[static_cast<std::size_t>(i)];
      columns.row(i) << harmonics_at(point.sent_deg).transpose(), point.sent_deg - sign * point.gyro_deg;
      own.row(i) << 1.0, point.time_s;
    }
    const Eigen::Matrix2d gram = own.transpose() * own;
    columns -= own * gram.ldlt().solve(own.transpose() * columns);
    normal += columns.leftCols<4>().transpose() * columns.leftCols<4>();
    right += columns.leftCols<4>().transpose() * columns.col(4);
  }
  Four solved() const { return normal.ldlt().solve(right); }
};

double root_mean_square_deg(const Four& harmonics) {
  return harmonics.norm() / std::sqrt(2.0);
}

Four harmonics_of(const EncoderProfile& encoder) {
  return {encoder.once_cosine_deg, encoder.once_sine_deg, encoder.twice_cosine_deg, encoder.twice_sine_deg};
}

/// Where the shaft is by the command while it rests, less where the sensor has it.
double offset_deg(std::span<const TimedShaft> shaft, std::span<const TimedServo> servo,
                  const EncoderProfile& encoder) {
  std::complex<double> sum;
  auto state = servo.begin();
  for (const TimedShaft& reading : shaft) {
    while (state != servo.end() && state->stamp.time < reading.stamp.time) ++state;
    if (state == servo.end()) break;
    if (!has_angle(reading.reading) || state->state.motion != ServoMotion::holding) continue;
    const double apart_deg = state->state.angle_deg - encoder.angle_deg(reading.reading.angle_deg);
    sum += std::polar(1.0, apart_deg * std::numbers::pi / 180.0);
  }
  return std::abs(sum) > 0.0 ? std::arg(sum) * 180.0 / std::numbers::pi : 0.0;
}

/// By second differences, which an even motion leaves out.
double reading_noise_deg(const std::vector<LegPoints>& legs) {
  RunningStatistics squares;
  for (const LegPoints& points : legs)
    for (std::size_t i = 2; i < points.size(); ++i) {
      const double apart = points[i].sent_deg - 2.0 * points[i - 1].sent_deg + points[i - 2].sent_deg;
      squares.add(apart * apart / 6.0);
    }
  return std::sqrt(squares.mean());
}

Estimate gyro_share_of(const std::vector<LegPoints>& legs, const EncoderProfile& encoder) {
  RunningStatistics shares;
  for (const LegPoints& points : legs) {
    const double turned_deg =
        encoder.angle_deg(points.back().sent_deg) - encoder.angle_deg(points.front().sent_deg);
    shares.add((points.back().gyro_deg - points.front().gyro_deg) / turned_deg);
  }
  return {shares.mean(), std::sqrt(shares.variance() / static_cast<double>(legs.size()))};
}

}  // namespace

EncoderFitResult fit_encoder(std::span<const TimedShaft> shaft, std::span<const TimedGyro> gyro,
                             std::span<const TimedServo> servo, const GyroErrors& errors,
                             const EncoderProfile& profile) {
  if (shaft.empty()) return {{}, "nothing measures the shaft"};
  if (gyro.empty() || servo.empty()) return {{}, "gyro or servo said nothing"};
  const HostTime origin = servo.front().stamp.time;
  const GyroIntegral integral(gyro, errors, origin);
  const std::vector<LegPoints> legs = points_of_legs(shaft, servo, integral, origin);
  EncoderFit fit{.encoder = profile, .legs = legs.size()};
  double along = 0.0;
  for (const LegPoints& points : legs) {
    const double sent_deg = points.back().sent_deg - points.front().sent_deg;
    along += sent_deg * (points.back().gyro_deg - points.front().gyro_deg);
    fit.turned_deg += std::abs(sent_deg);
  }
  if (legs.size() < fewest_legs || fit.turned_deg < fewest_turns * 360.0)
    return {{},
            fmt::format("its {} legs of {:.0f} deg/s and more turned the sensor by {:.0f} deg in all",
                        legs.size(), slowest_leg_dps, fit.turned_deg)};
  fit.encoder.sign = along < 0.0 ? -1 : 1;
  HarmonicSums all, even, odd;
  for (std::size_t i = 0; i < legs.size(); ++i) {
    HarmonicSums& half = i / 2 % 2 == 0 ? even : odd;  // legs come in pairs, there and back
    half.add(legs[i], fit.encoder.sign);
  }
  all.normal = even.normal + odd.normal;
  all.right = even.right + odd.right;
  const Four found = all.solved();
  fit.encoder.once_cosine_deg = found[0];
  fit.encoder.once_sine_deg = found[1];
  fit.encoder.twice_cosine_deg = found[2];
  fit.encoder.twice_sine_deg = found[3];
  fit.encoder.offset_deg = 0.0;
  fit.encoder.offset_deg = offset_deg(shaft, servo, fit.encoder);
  // Of the mean of two halves, by how far they are apart.
  fit.encoder.error_deg =
      std::hypot(root_mean_square_deg(even.solved() - odd.solved()) / 2.0, least_error_deg);
  fit.once_deg = found.head<2>().norm();
  fit.twice_deg = found.tail<2>().norm();
  fit.gyro_share = gyro_share_of(legs, fit.encoder);
  fit.noise_deg = reading_noise_deg(legs);
  return {fit, ""};
}

namespace {

/// What the sensor shows for each degree of another witness.
class Share {
 public:
  void add(double measured_dps, double other_dps) {
    across_ += measured_dps * other_dps;
    squares_ += other_dps * other_dps;
    measured_ += measured_dps * measured_dps;
    ++count_;
  }
  std::optional<Estimate> value() const {
    if (count_ < 4 || !(squares_ > 0.0)) return std::nullopt;
    const double share = across_ / squares_;
    const double left = std::max(0.0, measured_ - share * across_) / static_cast<double>(count_ - 1);
    return Estimate{share, std::sqrt(left / squares_)};
  }

 private:
  double across_ = 0.0, squares_ = 0.0, measured_ = 0.0;
  std::size_t count_ = 0;
};

struct ShaftShares {
  Share of_gyro, of_command;
};

ShaftShares shares_of(std::span<const TimedShaft> shaft, std::span<const TimedServo> servo,
                      const GyroIntegral& gyro, HostTime origin) {
  ShaftShares shares;
  std::size_t near = 0;
  auto reading = shaft.begin();
  for (const Interval& interval : steady_intervals(servo, origin, false)) {
    if (interval.leg == 0) continue;
    const TimedShaft* from = nullptr;
    for (; reading != shaft.end() && to_s(reading->stamp.time - origin) < interval.end_s; ++reading) {
      const double time_s = to_s(reading->stamp.time - origin);
      if (time_s <= interval.begin_s + after_ramp_s || !std::isfinite(reading->angle_deg)) continue;
      if (reading->lost_before || from == nullptr) from = &*reading;
      const double from_s = to_s(from->stamp.time - origin);
      if (time_s - from_s < share_window_s) continue;
      const double measured_dps = (reading->angle_deg - from->angle_deg) / (time_s - from_s);
      const double gyro_dps = gyro.mean_dps(from_s, time_s, near);
      from = &*reading;
      shares.of_command.add(measured_dps, interval.rate_dps);
      if (std::isfinite(gyro_dps)) shares.of_gyro.add(measured_dps, gyro_dps);
    }
  }
  return shares;
}

bool strays(const std::optional<Estimate>& share, double meant, double uncertainty) {
  return share && std::abs(share->value - meant) >
                      contradiction_deviations * std::hypot(share->uncertainty, uncertainty);
}

std::string contradiction_text(double share) {
  const std::string shown = fmt::format("it shows {:+.3f} deg for each degree of gyro and command", share);
  if (std::abs(share) < still_share)
    return shown + ": it does not turn with the shaft (is its magnet loose, or not on the shaft?)";
  if (share < 0.0)
    return shown + ": its direction is not that of its calibration (thermorig calibrate encoder)";
  return shown + ": its magnet slips, or a gear lies between it and the head";
}

}  // namespace

ShaftReport judge_shaft(std::span<const TimedShaft> shaft, std::span<const TimedGyro> gyro,
                        std::span<const TimedServo> servo, const GyroErrors& errors,
                        const RigProfile& profile, std::optional<double> maker_states_deg) {
  ShaftReport report;
  for (const TimedShaft& reading : shaft) {
    ++report.readings;
    if (!has_angle(reading.reading)) ++report.unread;
    if (has_angle(reading.reading) && reading.reading.status != ShaftStatus::good) ++report.poor;
  }
  if (shaft.empty()) return report;
  const EncoderProfile& encoder = profile.encoder;
  const bool is_calibrated = !encoder.measured_utc.empty();
  report.error_deg = is_calibrated ? encoder.error_deg : maker_states_deg.value_or(encoder.error_deg);
  if (report.unread == report.readings) {
    report.why_not = shaft.front().reading.status == ShaftStatus::absent ? "the sensor sees no magnet"
                                                                         : "the sensor did not answer";
    return report;
  }
  if (gyro.empty() || servo.empty()) {
    report.why_not = "neither gyro nor command bears it out";
    return report;
  }
  const HostTime origin = servo.front().stamp.time;
  const GyroIntegral integral(gyro, errors, origin);
  const ShaftShares shares = shares_of(shaft, servo, integral, origin);
  report.gyro_share = shares.of_gyro.value();
  report.command_share = shares.of_command.value();
  if (!is_calibrated && !maker_states_deg) {
    report.why_not = "it is not calibrated: thermorig calibrate encoder";
    return report;
  }
  const double command_uncertainty = std::hypot(profile.servo.scale_uncertainty, profile.servo.scale - 1.0);
  if (strays(report.gyro_share, 1.0, errors.scale.uncertainty) &&
      strays(report.command_share, profile.servo.scale, command_uncertainty)) {
    report.why_not = contradiction_text(report.gyro_share->value);
    return report;
  }
  const EncoderFitResult now = fit_encoder(shaft, gyro, servo, errors, encoder);
  if (now.fit && is_calibrated) {
    const double apart_deg = root_mean_square_deg(harmonics_of(now.fit->encoder) - harmonics_of(encoder));
    const double known_deg = std::hypot(now.fit->encoder.error_deg, encoder.error_deg);
    if (apart_deg > std::max(moved_deg, contradiction_deviations * known_deg)) {
      report.why_not = fmt::format(
          "its errors of a turn are {:.2f} deg from those of its calibration: the magnet has moved "
          "(thermorig calibrate encoder)",
          apart_deg);
      return report;
    }
  }
  report.used = true;
  return report;
}

}  // namespace thermorig::fit
