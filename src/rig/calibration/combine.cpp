// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <vector>

#include "thermorig/core/error.h"
#include "thermorig/core/statistics.h"
#include "thermorig/rig/calibration/calibration.h"

namespace thermorig::calibration {

namespace {

constexpr double least_uncertainty = 1e-9;  // one that is stated as nothing must not outweigh all others

template <typename Result, typename Value>
Estimate mean_of(std::span<const Result> results, Value value) {
  std::vector<Estimate> estimates;
  for (const Result& result : results)
    if (const std::optional<Estimate> estimate = value(result))
      estimates.push_back({estimate->value, std::max(estimate->uncertainty, least_uncertainty)});
  return weighted_mean(estimates);
}

}  // namespace

/// The bias of one session is not that of the next: the uncertainty is that of a session, not of the mean.
BiasResult combined(std::span<const BiasResult> results) {
  BiasResult all = results.front();
  all.bias_dps = mean_of(results, [](const BiasResult& result) { return std::optional(result.bias_dps); });
  all.rest_s = 0.0;
  for (const BiasResult& result : results) {
    all.rest_s += result.rest_s;
    all.noise_dps = std::max(all.noise_dps, result.noise_dps);
    if (std::abs(result.drift_dps) > std::abs(all.drift_dps)) all.drift_dps = result.drift_dps;
    const double off_dps = result.bias_dps.value - all.bias_dps.value;
    all.bias_dps.uncertainty =
        std::max(all.bias_dps.uncertainty, std::hypot(off_dps, result.bias_dps.uncertainty));
  }
  return all;
}

LatencyResult combined(std::span<const LatencyResult> results) {
  LatencyResult all = results.front();
  all.camera_latency_s =
      mean_of(results, [](const LatencyResult& result) { return std::optional(result.camera_latency_s); });
  all.offset_s = {all.camera_latency_s.value - all.before_s, all.camera_latency_s.uncertainty};
  all.halves = 0;
  for (const LatencyResult& result : results) all.halves += result.halves;
  return all;
}

ScaleResult combined(std::span<const ScaleResult> results) {
  ScaleResult all = results.front();
  all.gyro_scale =
      mean_of(results, [](const ScaleResult& result) { return std::optional(result.gyro_scale); });
  const bool driven = std::any_of(results.begin(), results.end(),
                                  [](const ScaleResult& result) { return result.servo_scale.has_value(); });
  if (driven)
    all.servo_scale = mean_of(results, [](const ScaleResult& result) { return result.servo_scale; });
  all.turned_deg = 0.0;
  for (const ScaleResult& result : results) all.turned_deg += result.turned_deg;
  return all;
}

OrientationResult combined(std::span<const OrientationResult> results) {
  OrientationResult all = results.front();
  for (const OrientationResult& result : results) {
    if (result.gyro_axis != all.gyro_axis || result.gyro_sign != all.gyro_sign ||
        result.mirrored != all.mirrored)
      throw Error(ExitCode::finished_lossy, "the sessions contradict each other about the orientation",
                  "calibrate orientation", "sessions of one rig only, put together in the same way");
    all.correlation = std::min(all.correlation, result.correlation);
    all.contrast = std::min(all.contrast, result.contrast);
  }
  return all;
}

LensResult combined(std::span<const LensResult> results) {
  LensResult all = results.front();
  all.pitch_scale =
      mean_of(results, [](const LensResult& result) { return std::optional(result.pitch_scale); });
  const auto mean = [&](std::optional<Estimate> LensResult::*value) -> std::optional<Estimate> {
    const bool is_told =
        std::any_of(results.begin(), results.end(), [&](const LensResult& one) { return one.*value; });
    if (!is_told) return std::nullopt;
    return mean_of(results, [&](const LensResult& one) { return one.*value; });
  };
  all.distortion = mean(&LensResult::distortion);
  all.tilt_deg = mean(&LensResult::tilt_deg);
  all.roll_deg = mean(&LensResult::roll_deg);
  all.row_spread = mean(&LensResult::row_spread);
  all.gyro_delay_s = mean(&LensResult::gyro_delay_s);
  all.halves = 0;
  for (const LensResult& result : results) {
    all.is_closed = all.is_closed || result.is_closed;
    all.turned_deg = std::max(all.turned_deg, result.turned_deg);
    all.halves += result.halves;
  }
  return all;
}

/// Errors are means of vectors, each a cosine and a sine; a zero is that of the first session.
EncoderResult combined(std::span<const EncoderResult> results) {
  EncoderResult all = results.front();
  const auto mean = [&](double EncoderProfile::*value) {
    return mean_of(results, [&](const EncoderResult& one) {
      return std::optional(Estimate{one.encoder.*value, one.encoder.error_deg});
    });
  };
  const auto member = {&EncoderProfile::once_cosine_deg, &EncoderProfile::once_sine_deg,
                       &EncoderProfile::twice_cosine_deg, &EncoderProfile::twice_sine_deg};
  double uncertainty = 0.0;
  for (double EncoderProfile::*const value : member) {
    const Estimate found = mean(value);
    all.encoder.*value = found.value;
    uncertainty = std::max(uncertainty, found.uncertainty);
  }
  all.encoder.error_deg = uncertainty;
  all.once_deg = std::hypot(all.encoder.once_cosine_deg, all.encoder.once_sine_deg);
  all.twice_deg = std::hypot(all.encoder.twice_cosine_deg, all.encoder.twice_sine_deg);
  all.gyro_share = mean_of(results, [](const EncoderResult& one) { return std::optional(one.gyro_share); });
  all.turned_deg = 0.0;
  all.legs = 0;
  for (const EncoderResult& result : results) {
    if (result.encoder.sign != all.encoder.sign)
      throw Error(ExitCode::finished_lossy,
                  "the sessions contradict each other about the encoder's direction", "calibrate encoder",
                  "sessions of one rig only, put together in the same way");
    all.turned_deg += result.turned_deg;
    all.legs += result.legs;
  }
  return all;
}

}  // namespace thermorig::calibration
