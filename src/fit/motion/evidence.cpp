// SPDX-License-Identifier: MIT
#include "evidence.h"

#include <algorithm>
#include <cmath>

namespace thermorig::motion {
namespace {

constexpr double narrowest_deg = 5.0;
constexpr double widest_deg = 180.0;
constexpr double lowest_scale = 0.2;
constexpr double highest_scale = 5.0;
constexpr double least_scale_uncertainty = 0.001;
constexpr double most_scale_uncertainty = 0.2;
constexpr double largest_bias_dps = 1000.0;
constexpr double bias_change_dps = 0.1;   // since the rests at which it was measured
constexpr double unknown_bias_dps = 3.0;  // of the mean rate of a rig that ends where it began, or nearly
constexpr double drift_rate = 0.002;      // deg/s a second: warming by a few degrees an hour, and random walk
constexpr double fastest_drift = 1.0;     // deg/s a second: no bias, and not a number
constexpr double any_offset_s = 0.2;

std::string nonsense(const View& view, const GyroErrors& errors) {
  if (!(view.field_of_view_deg >= narrowest_deg && view.field_of_view_deg <= widest_deg))
    return "the camera's field of view is not between 5 and 180 degrees";
  if (!(errors.scale.value > lowest_scale && errors.scale.value < highest_scale))
    return "the gyro's scale is not near 1";
  if (errors.bias_dps && !(std::abs(errors.bias_dps->value) < largest_bias_dps))
    return "the gyro's bias is beyond any gyro's";
  return {};
}

/// Uncertainties from files may be anything.
double sane(double uncertainty) {
  return uncertainty > 0.0 && uncertainty < largest_bias_dps ? uncertainty : 0.0;
}

/// How fast the bias went from the opening rest to the closing one, where nothing more is known.
double drift_between_rests(std::span<const TimedGyro> gyro, const GyroErrors& errors) {
  if (!errors.bias_before_dps || !errors.bias_after_dps || gyro.empty()) return 0.0;
  const double length_s = to_s(gyro.back().stamp.time - gyro.front().stamp.time);
  const double drift = (*errors.bias_after_dps - *errors.bias_before_dps) / length_s;
  return std::abs(drift) < fastest_drift ? drift : 0.0;
}

/// The gyro as if its bias had stayed, if it is known how it went, and as if it had shown it at rest, where
/// it zeroes itself: else taking the bias off would turn a rig that is at rest. Nothing, if neither is to be
/// done.
std::vector<TimedGyro> with_steady_bias(std::span<const TimedGyro> gyro, const GyroErrors& errors) {
  if (!errors.bias_dps || (errors.bias_course.empty() && !errors.zeroes_itself)) return {};
  const double steady_dps = errors.bias_dps->value;
  std::vector<TimedGyro> steady(gyro.begin(), gyro.end());
  for (TimedGyro& sample : steady)
    if (errors.zeroes_itself && sample.rate_dps == 0.0F)
      sample.rate_dps = static_cast<float>(steady_dps);
    else
      sample.rate_dps += static_cast<float>(steady_dps - bias_dps_at(errors, sample.stamp.time));
  return steady;
}

/// The bias where it is known, else the gyro's mean rate: a servo's travel ends somewhere.
Prior prior_of(const GyroErrors& errors, const AngleTrack& track, double drift_dps_per_s) {
  const double bias = errors.bias_dps ? errors.bias_dps->value : track.mean_rate_dps();
  const double bias_uncertainty_dps =
      errors.bias_dps ? std::hypot(sane(errors.bias_dps->uncertainty), bias_change_dps) : unknown_bias_dps;
  const double scale_uncertainty =
      std::clamp(sane(errors.scale.uncertainty), least_scale_uncertainty, most_scale_uncertainty);
  return {{0.0, bias, drift_dps_per_s, errors.scale.value},
          {any_offset_s, bias_uncertainty_dps, std::hypot(drift_rate, drift_dps_per_s), scale_uncertainty}};
}

}  // namespace

Evidence gather(std::span<const TimedFrame> frames, std::span<const TimedGyro> gyro, const View& view,
                const GyroErrors& errors, NewerHalf newer) {
  const std::vector<TimedGyro> steady = with_steady_bias(gyro, errors);
  Evidence evidence{
      AngleTrack(steady.empty() ? gyro : std::span<const TimedGyro>(steady)), {}, {}, nonsense(view, errors)};
  if (!evidence.why_not.empty()) return evidence;
  const double drift_dps_per_s = errors.bias_course.empty() ? drift_between_rests(gyro, errors) : 0.0;
  evidence.prior = prior_of(errors, evidence.track, drift_dps_per_s);
  evidence.halves =
      fresh_halves(frames, evidence.track, evidence.prior.mean[bias_dps], largest_offset_s, newer);
  if (!evidence.track.path().has_begun())
    evidence.why_not = "there is no gyro";
  else if (evidence.halves.size() < fewest_halves)
    evidence.why_not =
        "only " + std::to_string(evidence.halves.size()) + " half-frames have a gyro around them";
  return evidence;
}

Layout layout_of(const View& view, bool closed) {
  return {view.field_of_view_deg / frame_columns, view.mirrored, closed};
}

}  // namespace thermorig::motion
