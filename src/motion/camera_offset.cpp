// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "thermorig/motion/panorama_fit.h"
#include "weighted_mean.h"
#include "windows.h"

namespace thermorig::motion {
namespace {

constexpr std::size_t most_windows = 8;  // four thousand halves: more do not make it more certain
constexpr std::size_t fewest_halves = 40;
constexpr double worst_uncertainty_s = 0.005;
constexpr double least_contrast = 0.15;
// Pixels follow the scene with a lag of some ten milliseconds. Fine structure that passes fast is delayed a
// little less by it than coarse structure: as much as the surroundings make of it is not known.
constexpr double lag_error_s = 0.0003;

std::string refusal(std::span<const FreshHalf> halves, std::span<const TimedGyro> gyro) {
  if (gyro.empty()) return "there is no gyro";
  if (halves.size() < fewest_halves)
    return "only " + std::to_string(halves.size()) + " fresh chess halves have a gyro around them";
  const RateRange rates = rates_of(halves);
  if (fastest_dps(halves) < slowest_useful_dps) return "nothing turned";
  if (std::min(rates.positive_dps, -rates.negative_dps) < slowest_useful_dps)
    return "it turned one way only: delay shows where the same surroundings are passed in both directions";
  return {};
}

}  // namespace

CameraOffset camera_offset(std::span<const TimedFrame> frames, std::span<const TimedGyro> gyro,
                           const View& view, const GyroErrors& errors) {
  CameraOffset result;
  const AngleTrack track(gyro);
  const double bias_dps = likely_bias_dps(track, errors);
  const auto halves = fresh_halves(frames, track, bias_dps, largest_offset_s);
  result.why_not = refusal(halves, gyro);
  if (!result.why_not.empty()) return result;
  const Prior prior = prior_of(errors, bias_dps);
  std::vector<Estimate> told;
  std::optional<Parameters> start;
  for (const Window& window : moving_windows(halves, most_windows)) {
    if (!refusal(window, gyro).empty()) continue;
    std::vector<HalfView> views = views_of(window);
    Alignment alignment(views, track, layout_of(view, false), prior);
    alignment.refine(start ? *start : search_offset(alignment, prior), offset_s);
    const double uncertainty_s = std::sqrt(alignment.covariance()[offset_s][offset_s]);
    if (!(uncertainty_s < worst_uncertainty_s) || alignment.contrast() < least_contrast) continue;
    told.push_back({alignment.parameters()[offset_s], uncertainty_s});
    result.halves += static_cast<std::uint32_t>(views.size());
    if (!start) {
      start = prior.mean;
      (*start)[offset_s] = alignment.parameters()[offset_s];
    }
  }
  if (told.empty()) {
    result.why_not = "the surroundings show too little that could be recognised";
    return result;
  }
  result.offset_s = weighted_mean(told);
  result.offset_s->uncertainty = std::hypot(result.offset_s->uncertainty, lag_error_s);
  return result;
}

}  // namespace thermorig::motion
