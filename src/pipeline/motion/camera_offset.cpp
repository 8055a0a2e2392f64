// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "evidence.h"
#include "thermorig/pipeline/motion/panorama_fit.h"
#include "weighted_mean.h"
#include "windows.h"

namespace thermorig::motion {
namespace {

constexpr std::size_t most_windows = 8;  // four thousand halves: more do not make it more certain
constexpr double worst_uncertainty_s = 0.005;
constexpr double least_offset_contrast = 0.15;
// Pixels follow the scene with a lag of some ten milliseconds. Fine structure that passes fast is delayed a
// little less by it than coarse structure: as much as the surroundings make of it is not known.
constexpr double lag_error_s = 0.0003;

/// Both halves of a frame get its whole span where nobody knows which one came first.
bool is_order_unknown(const FreshHalf& half) {
  const auto& exposures = half.frame->half;
  return exposures[0].begin == exposures[1].begin && exposures[0].end == exposures[1].end;
}

/// Why those halves cannot tell a delay.
std::string refusal(std::span<const FreshHalf> halves) {
  const RateRange rates = rates_of(halves);
  if (fastest_dps(halves) < slowest_useful_dps) return "nothing turned";
  if (std::min(rates.positive_dps, -rates.negative_dps) < slowest_useful_dps)
    return "it turned one way only: a delay shows where the same surroundings pass in both directions";
  return {};
}

bool is_told(const Alignment& alignment) {
  return alignment.uncertainty(offset_s) < worst_uncertainty_s &&
         alignment.contrast() > least_offset_contrast &&
         std::abs(alignment.parameters()[offset_s]) < largest_offset_s;
}

}  // namespace

CameraOffset camera_offset(std::span<const TimedFrame> frames, std::span<const TimedGyro> gyro,
                           const View& view, const GyroErrors& errors) {
  CameraOffset result;
  Evidence evidence = gather(frames, gyro, view, errors);
  result.why_not = evidence.why_not.empty() ? refusal(evidence.halves) : evidence.why_not;
  std::erase_if(evidence.halves, is_order_unknown);
  if (result.why_not.empty() && evidence.halves.size() < fewest_halves)
    result.why_not = "which half of a frame is newer is not known";
  if (!result.why_not.empty()) return result;
  std::vector<Estimate> told;
  Parameters start = evidence.prior.mean;
  for (const Window& window : moving_windows(evidence.halves, most_windows)) {
    if (window.size() < fewest_halves || !refusal(window).empty()) continue;
    std::vector<HalfView> views = views_of(window);
    Alignment alignment(views, evidence.track, layout_of(view, false), evidence.prior);
    alignment.refine(told.empty() ? alignment.search_offset() : start, offset_s);
    if (!is_told(alignment)) continue;
    told.push_back({alignment.parameters()[offset_s], alignment.uncertainty(offset_s)});
    result.halves += static_cast<std::uint32_t>(views.size());
    start[offset_s] = told.back().value;
  }
  if (told.empty()) {
    result.why_not =
        "the surroundings show too little that could be recognised, or they do not turn with the gyro";
    return result;
  }
  result.offset_s = weighted_mean(told);
  result.offset_s->uncertainty = std::hypot(result.offset_s->uncertainty, lag_error_s);
  return result;
}

}  // namespace thermorig::motion
