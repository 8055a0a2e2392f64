// SPDX-License-Identifier: MIT
#include "thermorig/fit/shaft/gyro_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <vector>

#include "thermorig/core/gyro_delay.h"
#include "thermorig/core/statistics.h"
#include "thermorig/fit/shaft/intervals.h"

namespace thermorig::fit {

namespace {

constexpr double second_order_delay = GyroProfile::second_order_delay;
constexpr std::size_t segment = 128;  // samples of one spectrum
constexpr std::size_t lines = segment / 2;
constexpr std::size_t first_line = 2;                // below it the bias wanders
constexpr std::size_t lines_of_turning = lines / 2;  // above it a device's own sampling shows
constexpr std::size_t least_segments = 8;            // of all axes together
constexpr double most_rounding = 0.3;  // share of the variance: beyond, what rounding makes is not white
constexpr double moved = 3.0;          // times the usual variance: a hand was on the rig
constexpr double shaken_error = 0.3;   // of the delay: what gears shake is not white
constexpr double narrowest_hz = 4.0;
constexpr double widest_hz = 8000.0;  // as wide as samples are taken inside: no filter to speak of
constexpr int bandwidths = 141;
constexpr int aliases = 3;                                                // either side
constexpr std::array<double, 5> rounding_tried{0.5, 0.7, 1.0, 1.4, 2.0};  // of what the resolution makes

using Segment = std::array<double, segment>;
using Spectrum = std::array<double, lines>;

/// Samples of one axis in a row, at rest.
struct AxisSegment {
  std::size_t axis;
  Segment values;
  double variance;
};

double variance_of(const Segment& values) {
  double sum = 0.0, squares = 0.0;
  for (const double value : values) sum += value, squares += value * value;
  const double mean = sum / segment;
  return std::max(0.0, squares / segment - mean * mean);
}

double length_s(std::span<const TimedGyro> part) {
  return to_s(part.back().stamp.time - part.front().stamp.time);
}

/// Time between two samples where none is lost: a gyro's own clock may be off by more than a sample in a
/// segment.
double usual_period_s(std::span<const TimedGyro> gyro, double nominal_s) {
  std::vector<double> lengths_s;
  for (; gyro.size() >= segment; gyro = gyro.subspan(segment))
    lengths_s.push_back(length_s(gyro.first(segment)));
  return lengths_s.empty() ? nominal_s : median(std::move(lengths_s)) / (segment - 1.0);
}

/// Which noise is looked at: at rest that of all axes, while the shaft turns evenly that of those across it.
struct Heard {
  bool rests = true;
  std::size_t shaft_axis = 0;
  bool of(std::size_t axis) const { return rests || axis != shaft_axis; }
};

/// Of samples without a loss among them.
std::vector<AxisSegment> segments_of(std::span<const TimedGyro> gyro, std::span<const TimedServo> servo,
                                     double nominal_period_s, const Heard& heard) {
  std::vector<AxisSegment> found;
  if (servo.empty()) return found;
  const double period_s = usual_period_s(gyro, nominal_period_s);
  const HostTime origin = servo.front().stamp.time;
  const auto before = [](const TimedGyro& sample, HostTime time) { return sample.stamp.time < time; };
  for (const Interval& even : steady_intervals(servo, origin, heard.rests)) {
    const auto end = std::lower_bound(gyro.begin(), gyro.end(),
                                      origin + from_s(std::max(even.begin_s, even.end_s)), before);
    auto at = std::lower_bound(gyro.begin(), end, origin + from_s(even.begin_s + settled_after_s), before);
    for (; end - at >= static_cast<std::ptrdiff_t>(segment); at += segment) {
      const std::span part(at, segment);
      if (std::abs(length_s(part) / period_s - (segment - 1.0)) > 0.5) continue;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (!heard.of(axis)) continue;
        AxisSegment one{axis, {}, 0.0};
        for (std::size_t i = 0; i < segment; ++i)
          one.values[i] = static_cast<double>(part[i].reading.rate_dps[axis]);
        one.variance = variance_of(one.values);
        if (std::isfinite(one.variance)) found.push_back(one);
      }
    }
  }
  return found;
}

/// Smallest step between two values.
double resolution_of(const std::vector<AxisSegment>& segments) {
  double step = std::numeric_limits<double>::infinity();
  for (const AxisSegment& one : segments)
    for (std::size_t i = 1; i < segment; ++i) {
      const double change = std::abs(one.values[i] - one.values[i - 1]);
      if (change > 1e-9) step = std::min(step, change);
    }
  return step;
}

/// Power by frequency, of values without their mean, tapered as Hann has it.
void add_spectrum(const Segment& values, Spectrum& sum) {
  double mean = 0.0;
  for (const double value : values) mean += value / segment;
  Segment tapered{};
  for (std::size_t i = 0; i < segment; ++i)
    tapered[i] = (values[i] - mean) *
                 (1.0 - std::cos(2.0 * std::numbers::pi * (static_cast<double>(i) + 0.5) / segment));
  for (std::size_t line = 0; line < lines; ++line) {
    const std::complex<double> turn =
        std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(line) / segment);
    std::complex<double> total = 0.0, factor = 1.0;
    for (const double value : tapered) {
      total += value * factor;
      factor *= turn;
    }
    sum[line] += std::norm(total);
  }
}

/// Power that a low-pass leaves of white noise, with what sampling folds back onto it; its mean is 1. A
/// low-pass beyond half the rate leaves no mark but in what is folded back, which also goes by how the device
/// samples inside: noise does not tell it from none.
Spectrum shape_of(double bandwidth_hz, double rate_hz, double rounding) {
  Spectrum shape{};
  if (bandwidth_hz > rate_hz / 2.0) {
    shape.fill(1.0);
    return shape;
  }
  double sum = 0.0;
  for (std::size_t line = 0; line < lines; ++line) {
    for (int alias = -aliases; alias <= aliases; ++alias) {
      const double frequency_hz = (static_cast<double>(line) / segment + alias) * rate_hz;
      shape[line] += 1.0 / (1.0 + std::pow(frequency_hz / bandwidth_hz, 4));
    }
    sum += shape[line] / lines;
  }
  for (double& power : shape) power = (1.0 - rounding) * power / sum + rounding;
  return shape;
}

/// Logarithm of how likely the mean of `segments` spectra is if noise has that shape, whatever its strength
/// (Whittle's likelihood). A taper makes neighbouring lines go together: n of them tell as much as n * 18 /
/// 35 would that are independent. For Hann's w that is the squared sum of w^2 over the length times the sum
/// of w^4.
double log_likelihood(const Spectrum& mean, const Spectrum& shape, double segments, std::size_t behind_last) {
  double strength = 0.0, logs = 0.0;
  const auto used = static_cast<double>(behind_last - first_line);
  for (std::size_t line = first_line; line < behind_last; ++line) {
    strength += mean[line] / shape[line] / used;
    logs += std::log(shape[line]);
  }
  constexpr double independent = 18.0 / 35.0;
  return -independent * segments * (used * std::log(strength) + logs);
}

/// Mean and deviation of the delay over bandwidths that are evenly likely, before, in their logarithm.
Estimate delay_by(const Spectrum& mean, double segments, double rate_hz, double rounding,
                  std::size_t behind_last) {
  std::vector<double> delays_s, likelihoods;
  for (int i = 0; i < bandwidths; ++i) {
    const double bandwidth_hz = narrowest_hz * std::pow(widest_hz / narrowest_hz, i / (bandwidths - 1.0));
    for (const double share : rounding_tried) {
      const Spectrum shape = shape_of(bandwidth_hz, rate_hz, std::min(0.9, share * rounding));
      delays_s.push_back(second_order_delay / bandwidth_hz);
      likelihoods.push_back(log_likelihood(mean, shape, segments, behind_last));
    }
  }
  const double best = *std::max_element(likelihoods.begin(), likelihoods.end());
  double weights = 0.0, sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < delays_s.size(); ++i) {
    const double weight = std::exp(likelihoods[i] - best);
    weights += weight;
    sum += weight * delays_s[i];
    squares += weight * delays_s[i] * delays_s[i];
  }
  const double delay_s = sum / weights;
  const double variance = std::max(0.0, squares / weights - delay_s * delay_s);
  return {delay_s, std::hypot(std::sqrt(variance), stated_delay_error * delay_s)};
}

/// Segments whose variance is no more than that of most of their axis.
void keep_still(std::vector<AxisSegment>& segments) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<double> variances;
    for (const AxisSegment& one : segments)
      if (one.axis == axis) variances.push_back(one.variance);
    const double limit = moved * median(std::move(variances));
    std::erase_if(segments, [&](const AxisSegment& one) {
      return one.axis == axis && !(one.variance > 0.0 && one.variance <= limit);
    });
  }
}

std::optional<Estimate> delay_by_noise(std::span<const TimedGyro> gyro, std::span<const TimedServo> servo,
                                       double rate_hz, const Heard& heard) {
  std::vector<AxisSegment> segments = segments_of(gyro, servo, 1.0 / rate_hz, heard);
  keep_still(segments);
  if (segments.size() < least_segments) return std::nullopt;
  const double resolution = resolution_of(segments);
  double variance = 0.0;
  for (const AxisSegment& one : segments) variance += one.variance / static_cast<double>(segments.size());
  const double rounding = resolution * resolution / 12.0 / variance;
  if (!(rounding < most_rounding)) return std::nullopt;
  Spectrum mean{};
  for (const AxisSegment& one : segments) add_spectrum(one.values, mean);
  Estimate delay_s = delay_by(mean, static_cast<double>(segments.size()), rate_hz, rounding,
                              heard.rests ? lines : lines_of_turning);
  if (!heard.rests) delay_s.uncertainty = std::hypot(delay_s.uncertainty, shaken_error * delay_s.value);
  return delay_s;
}

/// By the noise at rest; of a gyro that shows none there, where nothing is stated, by that while it turns.
std::optional<Estimate> delay_by_noise(std::span<const TimedGyro> gyro, std::span<const TimedServo> servo,
                                       const GyroProfile& profile, bool zeroes_itself, bool is_stated) {
  if (zeroes_itself && is_stated) return std::nullopt;
  const Heard heard{.rests = !zeroes_itself, .shaft_axis = static_cast<std::size_t>(profile.axis)};
  return delay_by_noise(gyro, servo, profile.output_rate_hz, heard);
}

/// What the profile says, unless the device itself says otherwise.
std::optional<Estimate> stated_delay(const GyroProfile& profile, std::optional<double> device_hz) {
  if (device_hz)
    return Estimate{second_order_delay / *device_hz, stated_delay_error * second_order_delay / *device_hz};
  const auto delay_s = profile.stated_delay_s();
  if (!delay_s) return std::nullopt;
  return Estimate{*delay_s, delay_uncertainty_s(profile)};
}

}  // namespace

void fit_gyro_filter(std::span<const TimedGyro> gyro, std::span<const TimedServo> servo,
                     const GyroProfile& profile, GyroErrors& errors, std::optional<double> device_hz) {
  const bool is_stated = profile.bandwidth_hz > 0.0;
  const bool is_same =
      is_stated && device_hz && std::abs(*device_hz / profile.bandwidth_hz - 1.0) <= stated_delay_error;
  if (is_same) device_hz.reset();  // the profile may know the delay better
  const auto stated = stated_delay(profile, device_hz);
  const auto by_noise = delay_by_noise(gyro, servo, profile, errors.zeroes_itself, stated.has_value());
  const bool noise_contradicts = stated && by_noise && contradict(*stated, *by_noise);
  errors.filter_contradicts = noise_contradicts || (is_stated && device_hz);
  if (stated && !noise_contradicts) {
    errors.filter_source = device_hz ? "device" : "profile";
    errors.filter_delay_s = *stated;
  } else if (by_noise) {
    errors.filter_source = "noise";
    errors.filter_delay_s = *by_noise;
  } else {
    errors.filter_delay_s = {0.0, unknown_delay_s};
  }
}

}  // namespace thermorig::fit
