// SPDX-License-Identifier: MIT
#include "angle_model.h"

#include <algorithm>

namespace thermorig::motion {
namespace {

struct Range {
  double low;
  double high;
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  double middle() const { return 0.5 * (low + high); }
};

}  // namespace

AngleModel::AngleModel(std::span<const HalfView> views, const AngleTrack& track, const Prior& prior)
    : track_(track) {
  if (views.empty()) return;
  const FreshHalf& first = views.front().half;
  middle_s_ = first.middle_s();
  middle_deg_ = exposure(first, prior.mean).mean.angle_deg;
  Range times_s{middle_s_, middle_s_};
  Range angles_deg{0.0, 0.0};  // from the first
  for (const HalfView& view : views) {
    times_s.add(view.half.middle_s());
    angles_deg.add(angle_deg(view.half, prior.mean));
  }
  middle_deg_ +=
      angles_deg.middle() * prior.mean[scale] + prior.mean[bias_dps] * (times_s.middle() - middle_s_);
  middle_s_ = times_s.middle();
  reach_deg_ = 0.5 * (angles_deg.high - angles_deg.low);
}

AngleModel::Exposure AngleModel::exposure(const FreshHalf& half, const Parameters& parameters) const {
  const double offset = parameters[offset_s];
  return {half.middle_s() - offset - middle_s_, track_.over(half.begin_s - offset, half.end_s - offset)};
}

double AngleModel::angle_deg(const FreshHalf& half, const Parameters& parameters) const {
  const Exposure seen = exposure(half, parameters);
  const double mean_bias_dps = parameters[bias_dps] + 0.5 * parameters[drift_dps_per_s] * seen.since_s;
  return (seen.mean.angle_deg - middle_deg_ - mean_bias_dps * seen.since_s) / parameters[scale];
}

Parameters AngleModel::change(const FreshHalf& half, const Parameters& parameters) const {
  const Exposure seen = exposure(half, parameters);
  const double gain = 1.0 / parameters[scale];
  return {-(seen.mean.rate_dps - parameters[bias_dps]) * gain, -seen.since_s * gain,
          -0.5 * seen.since_s * seen.since_s * gain, -angle_deg(half, parameters) * gain};
}

}  // namespace thermorig::motion
