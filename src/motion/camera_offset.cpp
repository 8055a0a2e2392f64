// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "thermorig/motion/panorama_fit.h"
#include "windows.h"

namespace thermorig::motion {
namespace {

constexpr std::size_t most_windows = 16;
constexpr std::size_t fewest_halves = 40;
constexpr double slowest_dps = 10.0;  // below, a millisecond is a hundredth of a degree
constexpr double worst_uncertainty_s = 0.005;
constexpr double least_contrast = 0.15;

struct Told {
  Estimate offset_s;
  std::size_t halves = 0;
};

std::string refusal(std::span<const FreshHalf> halves, std::span<const TimedGyro> gyro) {
  if (gyro.empty()) return "there is no gyro";
  if (halves.size() < fewest_halves)
    return "only " + std::to_string(halves.size()) + " fresh chess halves have a gyro around them";
  const RateRange rates = rates_of(halves);
  if (std::max(rates.positive_dps, -rates.negative_dps) < slowest_dps) return "nothing turned";
  if (std::min(rates.positive_dps, -rates.negative_dps) < slowest_dps)
    return "it turned one way only: delay shows where the same surroundings are passed in both directions";
  return {};
}

Estimate combined(const std::vector<Told>& told) {
  double certainty = 0.0;
  double sum = 0.0;
  for (const Told& one : told) {
    const double weight = 1.0 / (one.offset_s.uncertainty * one.offset_s.uncertainty);
    certainty += weight;
    sum += weight * one.offset_s.value;
  }
  const double mean = sum / certainty;
  double chi_square = 0.0;
  for (const Told& one : told)
    chi_square += std::pow((one.offset_s.value - mean) / one.offset_s.uncertainty, 2);
  const double spread = told.size() > 1 ? chi_square / static_cast<double>(told.size() - 1) : 1.0;
  return {mean, std::sqrt(std::max(1.0, spread) / certainty)};
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
  std::vector<Told> told;
  std::optional<Parameters> start;
  for (const Window& window : moving_windows(halves, most_windows)) {
    if (!refusal(window, gyro).empty()) continue;
    std::vector<HalfView> views = views_of(window);
    Alignment alignment(views, track, layout_of(view, false), prior);
    alignment.refine(start ? *start : search_offset(alignment, prior));
    const double uncertainty_s = std::sqrt(alignment.covariance()[offset_s][offset_s]);
    if (!(uncertainty_s < worst_uncertainty_s) || alignment.contrast() < least_contrast) continue;
    told.push_back({{alignment.parameters()[offset_s], uncertainty_s}, views.size()});
    if (!start) {
      start = prior.mean;
      (*start)[offset_s] = alignment.parameters()[offset_s];
    }
  }
  if (told.empty()) {
    result.why_not = "the surroundings show too little that could be recognised";
    return result;
  }
  result.offset_s = combined(told);
  for (const Told& one : told) result.halves += static_cast<std::uint32_t>(one.halves);
  return result;
}

}  // namespace thermorig::motion
