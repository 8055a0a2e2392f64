// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "contest.h"
#include "thermorig/motion/panorama_fit.h"
#include "windows.h"

namespace thermorig::motion {
namespace {

constexpr std::size_t most_windows = 3;
constexpr std::size_t fewest_halves = 40;

struct Fit {
  std::vector<double> misfit;
  double mean = 0.0;    // of it
  double spread = 0.0;  // what it would be without a panorama
};

Fit fit(const Window& window, const AngleTrack& track, const View& view, const Prior& prior) {
  std::vector<HalfView> views = views_of(window);
  Alignment alignment(views, track, layout_of(view, false), prior);
  alignment.refine(search_offset(alignment, prior), offset_s);
  Fit fit{alignment.misfit(), 0.0, alignment.spread()};
  for (const double misfit : fit.misfit) fit.mean += misfit / static_cast<double>(fit.misfit.size());
  return fit;
}

/// What the two choices explain of the images, summed over windows.
struct Explained {
  double mirrored = 0.0;
  double upright = 0.0;
  double contrast() const {
    const double better = std::max(mirrored, upright);
    return better > 0.0 ? std::clamp(std::abs(mirrored - upright) / better, 0.0, 1.0) : 0.0;
  }
};

}  // namespace

Orientation orientation(std::span<const TimedFrame> frames, std::span<const TimedGyro> gyro, const View& view,
                        const GyroErrors& errors) {
  const AngleTrack track(gyro);
  const double bias = likely_bias_dps(track, errors);
  const Prior prior = prior_of(errors, bias);
  const auto halves = fresh_halves(frames, track, bias, largest_offset_s);
  Contest contest(sweeping_block_s);
  Explained explained;
  std::size_t used = 0;
  for (const Window& window : moving_windows(halves, most_windows)) {
    if (window.size() < fewest_halves || fastest_dps(window) < slowest_useful_dps) continue;
    const Fit mirrored = fit(window, track, {view.field_of_view_deg, true}, prior);
    const Fit upright = fit(window, track, {view.field_of_view_deg, false}, prior);
    contest.add(window, mirrored.misfit, upright.misfit);
    const double spread = std::max(mirrored.spread, upright.spread);
    explained.mirrored += spread - mirrored.mean;
    explained.upright += spread - upright.mean;
    used += window.size();
  }
  Orientation result{.mirrored = {}, .contrast = explained.contrast(), .why_not = {}};
  if (gyro.empty())
    result.why_not = "there is no gyro";
  else if (used == 0)
    result.why_not = "too few images were taken while the rig turned";
  else if (std::abs(contest.lead()) < clear_lead)
    result.why_not = "mirrored or not, the images fit equally well: the surroundings show too little";
  else
    result.mirrored = contest.lead() > 0.0;
  return result;
}

}  // namespace thermorig::motion
