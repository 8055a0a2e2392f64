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
    : views_(views), path_(track.path()) {
  if (views.empty()) return;
  middle_s_ = views.front().half.middle_s();
  look_from(prior.mean[offset_s]);
  middle_deg_ = exposures_.front().mean.turned_deg;
  Range times_s{middle_s_, middle_s_};
  Range angles_deg{0.0, 0.0};  // from the first
  for (std::size_t i = 0; i < views.size(); ++i) {
    times_s.add(views[i].half.middle_s());
    angles_deg.add(angle_deg(i, prior.mean));
  }
  middle_deg_ +=
      angles_deg.middle() * prior.mean[scale] + prior.mean[bias_dps] * (times_s.middle() - middle_s_);
  middle_s_ = times_s.middle();
  reach_deg_ = 0.5 * (angles_deg.high - angles_deg.low);
  exposures_.clear();  // their times count from the middle
}

void AngleModel::look_from(double offset) {
  if (offset == offset_s_ && exposures_.size() == views_.size()) return;
  offset_s_ = offset;
  exposures_.clear();
  exposures_.reserve(views_.size());
  for (const HalfView& view : views_)
    exposures_.push_back({view.half.middle_s() - offset - middle_s_,
                          path_.mean_over(view.half.begin_s - offset, view.half.end_s - offset)});
}

double AngleModel::angle_deg(std::size_t index, const Parameters& parameters) const {
  const Exposure& seen = exposures_[index];
  const double mean_bias_dps = parameters[bias_dps] + 0.5 * parameters[drift_dps_per_s] * seen.since_s;
  return (seen.mean.turned_deg - middle_deg_ - mean_bias_dps * seen.since_s) / parameters[scale];
}

Parameters AngleModel::change(std::size_t index, const Parameters& parameters) const {
  const Exposure& seen = exposures_[index];
  const double gain = 1.0 / parameters[scale];
  return {-(seen.mean.rate_dps - parameters[bias_dps]) * gain, -seen.since_s * gain,
          -0.5 * seen.since_s * seen.since_s * gain, -angle_deg(index, parameters) * gain};
}

}  // namespace thermorig::motion
