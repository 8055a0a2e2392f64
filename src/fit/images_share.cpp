// SPDX-License-Identifier: MIT
#include "images_share.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "thermorig/core/statistics.h"
#include "thermorig/estimators/likelihood/camera_rate.h"
#include "thermorig/fit/shaft/intervals.h"

namespace thermorig::fit {

namespace {

constexpr std::size_t most_legs = 24;
constexpr std::size_t most_frames = 16;  // of a leg
constexpr std::size_t fewest_looks = 3;  // that make a leg's median one
constexpr std::size_t fewest_legs = 3;
constexpr double slowest_dps = 15.0;  // below it noise is much of the rate
constexpr double told_share = 0.5;    // of the windows: else chance chooses which ones know their rate
constexpr double worst_uncertainty = 0.1;

struct LegView {
  Interval leg;
  std::span<const TimedFrame> frames;  // exposed while its speed was steady
};

/// Legs with their frames; speeds that are too slow or too fast for images are left out.
std::vector<LegView> views_of(std::span<const TimedFrame> frames, std::span<const TimedServo> servo) {
  std::vector<LegView> views;
  const HostTime origin = servo.front().stamp.time;
  auto first = frames.begin();
  for (const Interval& leg : steady_intervals(servo, origin, false)) {
    const double speed_dps = std::abs(leg.rate_dps);
    if (leg.leg == 0 || speed_dps < slowest_dps || speed_dps > likelihood::fastest_dps) continue;
    const HostTime begin = origin + from_s(leg.begin_s + settled_after_s), end = origin + from_s(leg.end_s);
    first = std::find_if(first, frames.end(),
                         [&](const TimedFrame& frame) { return frame.exposure_begin >= begin; });
    auto last =
        std::find_if(first, frames.end(), [&](const TimedFrame& frame) { return frame.exposure_end > end; });
    const auto count = std::min(most_frames, static_cast<std::size_t>(last - first));
    if (count > fewest_looks) views.push_back({leg, {first, count}});
  }
  return views;
}

/// Evenly spread ones of the slower half: what a weak servo fails at first is speed, and slow images overlap
/// more.
std::vector<LegView> some_of(const std::vector<LegView>& views) {
  std::vector<double> speeds_dps;
  for (const LegView& view : views) speeds_dps.push_back(std::abs(view.leg.rate_dps));
  const double usual_dps = median(std::move(speeds_dps));
  std::vector<LegView> slower, some;
  for (const LegView& view : views)
    if (std::abs(view.leg.rate_dps) <= usual_dps) slower.push_back(view);
  if (slower.size() <= most_legs) return slower;
  for (std::size_t i = 0; i < most_legs; ++i) some.push_back(slower[i * slower.size() / most_legs]);
  return some;
}

}  // namespace

ImagesShare images_share(std::span<const TimedFrame> frames, std::span<const TimedServo> servo,
                         const CameraProfile& camera) {
  if (frames.empty() || servo.empty()) return {{}, "there is no leg with frames"};
  likelihood::CameraRate rate(camera, likelihood::most_window_frames);
  std::vector<double> shares;
  std::size_t looks = 0, told = 0;
  for (const LegView& view : some_of(views_of(frames, servo))) {
    std::vector<double> of_leg;
    for (const TimedFrame& frame : view.frames) {
      const likelihood::CameraRateReport report = rate.add(frame);
      looks += report.is_complete ? 1 : 0;
      if (report.is_told) of_leg.push_back(report.rate_dps / view.leg.rate_dps);
    }
    told += of_leg.size();
    if (of_leg.size() >= fewest_looks) shares.push_back(median(std::move(of_leg)));
  }
  if (looks == 0) return {{}, "there is no leg with frames"};
  if (shares.size() < fewest_legs || static_cast<double>(told) < told_share * static_cast<double>(looks))
    return {{}, "too little image detail"};
  const double share = median(shares);
  const double uncertainty =
      median_scatter * robust_deviation(shares, share) / std::sqrt(static_cast<double>(shares.size()));
  if (!(uncertainty < worst_uncertainty)) return {{}, "they do not agree among themselves"};
  return {Estimate{share, uncertainty}, {}};
}

}  // namespace thermorig::fit
