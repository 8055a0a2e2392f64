// SPDX-License-Identifier: MIT
#include <cmath>

#include "contest.h"
#include "evidence.h"
#include "thermorig/fit/motion/panorama_fit.h"
#include "windows.h"

namespace thermorig::motion {
namespace {

constexpr std::size_t most_half_windows = 4;

std::vector<double> misfit(const Window& window, const Evidence& evidence, const View& view) {
  std::vector<HalfView> views = views_of(window);
  Alignment alignment(views, evidence.track, layout_of(view, false), evidence.prior);
  alignment.refine(alignment.search_offset(), offset_s);
  return alignment.misfit();
}

}  // namespace

std::optional<unsigned> newer_half(std::span<const TimedFrame> frames, std::span<const TimedGyro> gyro,
                                   const View& view, const GyroErrors& errors) {
  const Evidence evidence = gather(frames, gyro, view, errors, 0U);
  if (!evidence.why_not.empty()) return std::nullopt;
  Contest contest(sweeping_block_s);
  for (const Window& window : moving_windows(evidence.halves, most_half_windows)) {
    if (window.size() < fewest_halves || fastest_dps(window) < slowest_useful_dps) continue;
    contest.add(window, misfit(window, evidence, view),
                misfit(dealt_anew(window, evidence.track, 1U), evidence, view));
    if (std::abs(contest.lead()) > 2.0 * clear_lead) break;
  }
  if (std::abs(contest.lead()) < clear_lead) return std::nullopt;
  return contest.lead() > 0.0 ? 0U : 1U;
}

}  // namespace thermorig::motion
