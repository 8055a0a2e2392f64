// SPDX-License-Identifier: MIT
#include "thermorig/estimators/odometer/lens_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "lens.h"
#include "lens_adjustment.h"
#include "thermorig/core/surroundings/half_frame.h"
#include "thermorig/core/surroundings/turn_path.h"
#include "tracker.h"

namespace thermorig::odometer {

namespace {

constexpr std::size_t most_fitted = 1600;   // halves: 200 s at 8 a second
constexpr std::size_t fewest_fitted = 160;  // that were seen at a steady, slow speed
constexpr std::size_t fewest_begun = 80;    // of them, with the nominal lens
constexpr double fewest_at_first = 0.3;     // share of the halves, with the nominal lens: less is no panorama
constexpr double enough_share = 0.9;        // another round would find no more
constexpr int most_rounds_of_passes = 4;
constexpr double lost_half = 2.0;  // of the least mean square
// And with the lens that was found: the others saw a bare wall or somebody.
constexpr double fewest_share = 0.5;
constexpr std::size_t learning_halves = 40;  // the map is being begun
constexpr double least_turned_deg = 120.0;
constexpr double slowest_dps = 4.0, fastest_dps = 70.0;  // beyond, images are blurred by more than 5 pixels
constexpr double steady_dps = 4.0;
constexpr double rest_dps = 5.0;
constexpr double trust = 0.05;         // of the likelihood: halves share the errors of one map
constexpr double closing_share = 0.7;  // of the view: so much of it is to be seen again after a turn
constexpr std::array<double, 7> tried_latencies_s{-0.06, -0.04, -0.02, 0.0, 0.02, 0.04, 0.06};
constexpr std::array<double, 5> tried_spreads{0.0, -0.9, -0.45, 0.45, 0.9};
constexpr std::array<double, 3> tried_again_s{-0.01, 0.0, 0.01};
constexpr double tried_latency_sigma_s = 0.01;
constexpr double lost_share = 0.05;  // of the halves, fewer than the round before: it lost its way
constexpr double more_share = 0.02;  // more than the round before: worth another one

/// A recording as a tracker takes it.
struct Sweep {
  TurnPath path{1};
  std::vector<HalfFrame> halves;
};

/// Where all halves look, with one lens.
struct Pass {
  std::vector<SweptHalf> halves;  // that are good for the lens
  Priors learnt;
  double judged_share = 0.0;  // of all halves: the rest fitted nothing that was seen before
  double mean_square = std::numeric_limits<double>::infinity();  // of pixels, robust: K^2
};

/// From the first motion on.
Sweep sweep_of(std::span<const TimedFrame> frames, std::span<const TimedGyro> gyro,
               const GyroProfile& profile) {
  Sweep sweep;
  if (gyro.empty()) return sweep;
  const HostTime origin = gyro.front().stamp.time;
  sweep.path = TurnPath(gyro.size());
  double before_s = 0.0;
  std::optional<double> moving_since_s;
  for (const TimedGyro& sample : gyro) {
    const double time_s = to_s(sample.stamp.time - origin);
    if (!is_rate(sample.rate_dps) || (sweep.path.has_begun() && time_s <= before_s)) continue;
    const double step_s = sweep.path.has_begun() ? time_s - before_s : 0.0;
    before_s = time_s;
    const double unseen = unseen_deg(lost_s(step_s, 1.0 / profile.output_rate_hz));
    sweep.path.add(time_s, double{sample.rate_dps}, unseen * unseen);
    if (!moving_since_s && std::abs(double{sample.rate_dps} - profile.bias_dps) > rest_dps)
      moving_since_s = time_s;
  }
  if (!sweep.path.has_begun()) return sweep;
  const double first_s = std::max(sweep.path.begin_s(), moving_since_s.value_or(before_s) - 1.0);
  for (const TimedFrame& frame : frames) {
    for (const unsigned parity : frame.halves_by_time()) {
      if (sweep.halves.size() == most_fitted) return sweep;
      const auto half = half_of(frame, parity, origin);
      if (half && half->begin_s > first_s && half->end_s < before_s) sweep.halves.push_back(*half);
    }
  }
  return sweep;
}

/// All halves with such a lens, one after the other.
Pass pass_with(const Sweep& sweep, const CameraProfile& camera, const Priors& begun_with) {
  const auto lens = std::make_shared<const Lens>(camera);
  Tracker tracker(begun_with, lens);
  // As where people walk: what fits badly, by a lens that is another one, counts less and is followed less.
  tracker.restart(begun_with, lens->rows(), true);
  Pass pass;
  double squares_k2 = 0.0, judged = 0.0, before_s = 0.0, before_deg = 0.0;
  bool was_good = false;
  for (std::size_t i = 0; i < sweep.halves.size(); ++i) {
    const HalfFrame& half = sweep.halves[i];
    if (!tracker.has_begun() || half.end_s > tracker.now_s()) tracker.advance(sweep.path, half.end_s);
    const HalfResult result = tracker.add(half, sweep.path);
    const bool is_seen = result.is_judged && result.is_used;
    if (is_seen && i >= learning_halves) {
      judged += 1.0;
      squares_k2 += result.left_k2;
    }
    const HeadingFilter& filter = tracker.filter();
    const ExposedTurn turn =
        sweep.path.over(half.begin_s - filter.latency_s(), half.end_s - filter.latency_s());
    const double rate_dps = std::abs(tracker.rate_dps());
    const bool is_good =
        is_seen && rate_dps > slowest_dps && rate_dps < fastest_dps && std::abs(turn.change_dps) < steady_dps;
    if (is_good)
      pass.halves.push_back(
          {.half = &half,
           .heading_deg = tracker.in_map_deg(),
           .rate_dps = tracker.rate_dps(),
           .turned_deg = (turn.mean_deg - before_deg - filter.bias_dps() * (turn.mean_s - before_s)) /
                         filter.scale_factor(),
           .follows = was_good});
    was_good = is_good;
    before_s = turn.mean_s;
    before_deg = turn.mean_deg;
  }
  pass.learnt = tracker.learnt(begun_with);
  pass.judged_share = judged / static_cast<double>(sweep.halves.size());
  if (pass.judged_share >= fewest_at_first) pass.mean_square = squares_k2 / judged;
  return pass;
}

/// Halves that fitted nothing count as if their pixels were off by twice the least mean square.
const Pass& sharpest(const std::vector<Pass>& passes) {
  double least = std::numeric_limits<double>::infinity();
  for (const Pass& one : passes) least = std::min(least, one.mean_square);
  const auto cost = [least](const Pass& one) {
    return std::isfinite(one.mean_square)
               ? one.judged_share * one.mean_square + (1.0 - one.judged_share) * lost_half * least
               : one.mean_square;
  };
  return *std::min_element(passes.begin(), passes.end(),
                           [&](const Pass& one, const Pass& other) { return cost(one) < cost(other); });
}

struct Tried {
  LensValues values{};
  Priors priors;
};

std::vector<Pass> passes_with(const std::vector<Tried>& all, const Sweep& sweep, const CameraProfile& camera,
                              const RunAll& run_all) {
  std::vector<Pass> passes(all.size());
  run_all(all.size(), [&](std::size_t i) {
    passes[i] = pass_with(sweep, camera_with(camera, all[i].values), all[i].priors);
  });
  return passes;
}

/// The sharpest pass of those that begin with a latency about that of the priors.
Pass sharpest_about(std::span<const double> latencies_s, const LensValues& values, const Priors& priors,
                    const Sweep& sweep, const CameraProfile& camera, const RunAll& run_all) {
  std::vector<Tried> tried;
  for (const double more_s : latencies_s) {
    tried.push_back({values, priors});
    tried.back().priors.latency_s += more_s;
    tried.back().priors.latency_sigma_s = tried_latency_sigma_s;
  }
  return sharpest(passes_with(tried, sweep, camera, run_all));
}

/// Headings by the odometer's tracker: latency and the order of the rows from a grid, the nominal lens.
struct Beginning {
  Pass pass;
  Priors priors;
  LensValues values{};
};
Beginning begin(const Sweep& sweep, const GyroProfile& gyro, const CameraProfile& camera,
                const RunAll& run_all) {
  Priors priors;
  priors.bias_dps = gyro.bias_dps;
  priors.bias_sigma_dps = gyro.bias_uncertainty_dps;
  priors.scale = gyro.scale;
  priors.scale_sigma = std::max(0.002, gyro.scale_uncertainty);
  Priors better = sharpest_about(tried_latencies_s, {}, priors, sweep, camera, run_all).learnt;
  better.latency_sigma_s = tried_latency_sigma_s;
  std::vector<Tried> tried;
  for (const double row_spread : tried_spreads) {
    tried.push_back({{}, better});
    tried.back().values[lens_rows] = row_spread;
  }
  const std::vector<Pass> passes = passes_with(tried, sweep, camera, run_all);
  const auto best = static_cast<std::size_t>(&sharpest(passes) - passes.data());
  Beginning beginning{passes[best], priors};
  beginning.priors.latency_s = passes[best].learnt.latency_s;
  beginning.priors.latency_sigma_s = tried_latency_sigma_s;
  beginning.values = tried[best].values;
  return beginning;
}

double turned_deg(const std::vector<SweptHalf>& halves) {
  const auto [low, high] = std::minmax_element(
      halves.begin(), halves.end(),
      [](const SweptHalf& one, const SweptHalf& other) { return one.heading_deg < other.heading_deg; });
  return halves.empty() ? 0.0 : high->heading_deg - low->heading_deg;
}

/// The same with a lens that is better known: more halves find their heading. A latency that is a little off
/// can lose a tracker its way, so that several are tried.
Beginning again(const Sweep& sweep, const Beginning& before, const CameraProfile& camera,
                const RunAll& run_all) {
  LensAdjustment adjustment(before.pass.halves, camera, before.values, trust);
  adjustment.run();
  const LensValues& values = adjustment.values();
  Beginning next{sharpest_about(tried_again_s, values, before.priors, sweep, camera, run_all), before.priors,
                 values};
  next.priors.latency_s = next.pass.learnt.latency_s;
  return next;
}

LensFit fit_from(const Beginning& beginning, const GyroProfile& gyro, const CameraProfile& camera) {
  const std::vector<SweptHalf>& halves = beginning.pass.halves;
  LensAdjustment adjustment(halves, camera, beginning.values, trust);
  adjustment.run();
  const auto told = [&](LensValue value) {
    return Estimate{adjustment.values()[value], adjustment.uncertainty(value)};
  };
  LensFit fit;
  fit.pitch_scale = told(lens_pitch);
  fit.pitch_scale.value += 1.0;
  fit.distortion = told(lens_distortion);
  fit.tilt_deg = told(lens_tilt);
  fit.roll_deg = told(lens_roll);
  fit.row_spread = told(lens_rows);
  fit.turned_deg = turned_deg(halves);
  fit.is_closed = fit.turned_deg > whole_turn_deg - (1.0 - closing_share) * camera.field_of_view_deg;
  if (!fit.is_closed)
    fit.pitch_scale.uncertainty = std::hypot(fit.pitch_scale.uncertainty, gyro.scale_uncertainty);
  fit.halves = static_cast<std::uint32_t>(halves.size());
  return fit;
}

}  // namespace

LensAnswer fit_lens(std::span<const TimedFrame> frames, std::span<const TimedGyro> gyro,
                    const GyroProfile& gyro_profile, const CameraProfile& camera, const RunAll& run_all) {
  const Sweep sweep = sweep_of(frames, gyro, gyro_profile);
  if (sweep.halves.size() < fewest_fitted)
    return {
        {},
        "there are only " + std::to_string(sweep.halves.size()) + " half-frames from the first motion on"};
  const auto too_few = [](const Beginning& beginning, std::size_t fewest) -> std::string {
    const std::vector<SweptHalf>& halves = beginning.pass.halves;
    if (halves.size() < fewest)
      return "only " + std::to_string(halves.size()) + " half-frames were seen at a steady speed below " +
             std::to_string(std::lround(fastest_dps)) + " deg/s and fit what was seen before";
    if (turned_deg(halves) < least_turned_deg)
      return "the rig turned through " + std::to_string(std::lround(turned_deg(halves))) +
             " degrees slowly enough";
    return "";
  };
  Beginning beginning = begin(sweep, gyro_profile, camera, run_all);
  if (!std::isfinite(beginning.pass.mean_square)) return {{}, "the images make no panorama"};
  for (int i = 0; i < most_rounds_of_passes; ++i) {
    if (const std::string why = too_few(beginning, fewest_begun); !why.empty()) return {{}, why};
    Beginning next = again(sweep, beginning, camera, run_all);
    const double more = next.pass.judged_share - beginning.pass.judged_share;
    if (more < -lost_share) break;
    beginning = std::move(next);
    if (more < more_share || beginning.pass.judged_share > enough_share) break;
  }
  if (const std::string why = too_few(beginning, fewest_fitted); !why.empty()) return {{}, why};
  if (beginning.pass.judged_share < fewest_share)
    return {{},
            "only " + std::to_string(std::lround(100.0 * beginning.pass.judged_share)) +
                " % of the images fit into one panorama, whatever the lens"};
  return {fit_from(beginning, gyro_profile, camera), ""};
}

}  // namespace thermorig::odometer
