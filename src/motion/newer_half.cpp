// SPDX-License-Identifier: MIT
#include <cmath>

#include "contest.h"
#include "thermorig/motion/panorama_fit.h"
#include "windows.h"

namespace thermorig::motion {
namespace {

constexpr std::size_t most_windows = 4;
constexpr std::size_t fewest_halves = 40;

std::vector<double> misfit(const Window& window, const AngleTrack& track, const View& view,
                           const Prior& prior) {
  std::vector<HalfView> views = views_of(window);
  Alignment alignment(views, track, layout_of(view, false), prior);
  alignment.refine(search_offset(alignment, prior), offset_s);
  return alignment.misfit();
}

}  // namespace

std::optional<unsigned> newer_half(std::span<const TimedFrame> frames, std::span<const TimedGyro> gyro,
                                   const View& view, const GyroErrors& errors) {
  const AngleTrack track(gyro);
  const double bias = likely_bias_dps(track, errors);
  const Prior prior = prior_of(errors, bias);
  Contest contest(sweeping_block_s);
  const auto halves = fresh_halves(frames, track, bias, largest_offset_s, 0U);
  for (const Window& window : moving_windows(halves, most_windows)) {
    if (window.size() < fewest_halves || fastest_dps(window) < slowest_useful_dps) continue;
    contest.add(window, misfit(window, track, view, prior),
                misfit(dealt_anew(window, track, 1U), track, view, prior));
    if (std::abs(contest.lead()) > 2.0 * clear_lead) break;
  }
  if (std::abs(contest.lead()) < clear_lead) return std::nullopt;
  return contest.lead() > 0.0 ? 0U : 1U;
}

}  // namespace thermorig::motion
