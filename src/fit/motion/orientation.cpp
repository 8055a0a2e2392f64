// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "contest.h"
#include "evidence.h"
#include "thermorig/fit/motion/panorama_fit.h"
#include "windows.h"

namespace thermorig::motion {
namespace {

constexpr std::size_t most_orientation_windows = 3;

struct Fit {
  std::vector<double> misfit;
  double mean = 0.0;    // of it
  double spread = 0.0;  // what it would be without a panorama
};

Fit fit(const Window& window, const Evidence& evidence, const View& view) {
  std::vector<HalfView> views = views_of(window);
  Alignment alignment(views, evidence.track, layout_of(view, false), evidence.prior);
  alignment.refine(alignment.search_offset(), offset_s);
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
  const Evidence evidence = gather(frames, gyro, view, errors);
  if (!evidence.why_not.empty()) return {.mirrored = {}, .contrast = 0.0, .why_not = evidence.why_not};
  Contest contest(sweeping_block_s);
  Explained explained;
  for (const Window& window : moving_windows(evidence.halves, most_orientation_windows)) {
    if (window.size() < fewest_halves || fastest_dps(window) < slowest_useful_dps) continue;
    const Fit mirrored = fit(window, evidence, {view.field_of_view_deg, true});
    const Fit upright = fit(window, evidence, {view.field_of_view_deg, false});
    contest.add(window, mirrored.misfit, upright.misfit);
    const double spread = std::max(mirrored.spread, upright.spread);
    explained.mirrored += spread - mirrored.mean;
    explained.upright += spread - upright.mean;
  }
  Orientation result{.mirrored = {}, .contrast = explained.contrast(), .why_not = {}};
  if (contest.empty())
    result.why_not = "too few images were taken while the rig turned";
  else if (std::abs(contest.lead()) < clear_lead)
    result.why_not = "mirrored or not, the images fit equally well: too little image detail";
  else
    result.mirrored = contest.lead() > 0.0;
  return result;
}

}  // namespace thermorig::motion
