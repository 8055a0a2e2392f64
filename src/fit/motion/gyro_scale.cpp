// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "contest.h"
#include "evidence.h"
#include "thermorig/core/statistics.h"
#include "thermorig/fit/motion/panorama_fit.h"
#include "windows.h"

namespace thermorig::motion {
namespace {

constexpr double least_overlap = 0.3;           // of the field of view, after a turn that just misses closing
constexpr double searched_uncertainties = 3.0;  // of the scale that is assumed
constexpr double free_scale = 0.1;              // the result owes nothing to that assumption
constexpr double step_pixels = 0.5;             // that far the ends of the turn move from one try to the next
constexpr double apart_pixels = 4.0;            // tries closer than that are the same place
constexpr int most_steps = 250;
constexpr int coarse_steps = 3;        // a bin is wider: what is sharp shows at one of so many steps
constexpr double coarse_share = 0.25;  // of the coarse steps, about which all are tried
constexpr std::size_t searched_halves = 250;
constexpr int closing_rounds = 2;
constexpr double left_both_ways = 0.2;
constexpr double repeated_readings = 3.0;    // of the uncertainty: neighbouring readings go wrong together
constexpr double most_turned_deg = 18000.0;  // fifty turns in a window: not a rig
constexpr double least_scale_contrast = 0.1;
constexpr double worst_uncertainty = 0.01;
constexpr double glance_s = 0.25;  // few halves see the end of a turn: each pair is a witness
// A quarter of a pixel: lens, lag and what is near are seen differently at either end of a turn. The scales
// of single turns of 43 rigs in the world "typical" scattered by 0.11 %, 0.08 % of which this is.
constexpr double model_error_deg = 0.4;

double angle_deg(const FreshHalf& half, const Evidence& evidence) {
  const Parameters& known = evidence.prior.mean;
  return (evidence.track.path().mean_over(half.begin_s, half.end_s).turned_deg -
          known[bias_dps] * half.middle_s()) /
         known[scale];
}

/// By the corrected gyro.
struct Turned {
  double lowest_deg = 0.0;
  double highest_deg = 0.0;
  double span_deg() const { return highest_deg - lowest_deg; }
  /// May a half at that angle look at what was seen a whole turn before or after?
  bool is_seen_twice(double angle, double field_of_view_deg) const {
    return angle + field_of_view_deg > lowest_deg + whole_turn_deg ||
           angle - field_of_view_deg < highest_deg - whole_turn_deg;
  }
};

Turned turned_in(const Window& window, const Evidence& evidence) {
  Turned turned{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  for (const FreshHalf& half : window) {
    turned.lowest_deg = std::min(turned.lowest_deg, angle_deg(half, evidence));
    turned.highest_deg = std::max(turned.highest_deg, angle_deg(half, evidence));
  }
  return turned;
}

// What is seen a moment later says how far the columns are apart, by the gyro's angle between: a lens that is
// wider than stated, or a scene close to a camera off the axis, looks like another scale. Only what is seen a
// whole turn later says what a degree is. So scales are tried along the valley in which neighbouring images
// stay sharp: the product of scale and pitch is held.

/// What neighbouring images show, at the pitch that is stated.
struct Valley {
  Parameters parameters;
  double bias_uncertainty_dps = 0.0;
  double contrast = 0.0;
  double stated_pitch_deg = 0.0;
  double pitch_deg(double at_scale) const { return stated_pitch_deg * parameters[scale] / at_scale; }
};

bool goes_both_ways(const Window& window) {
  const RateRange rates = rates_of(window);
  return std::min(rates.positive_dps, -rates.negative_dps) >= slowest_useful_dps;
}

/// Turns are taken for as many places: that works without knowing where one closes.
Valley find_valley(const Window& window, const Evidence& evidence, const Layout& open, Alignment& alignment) {
  alignment.refine(goes_both_ways(window) ? alignment.search_offset() : evidence.prior.mean, scale);
  return {alignment.parameters(), alignment.uncertainty(bias_dps), alignment.contrast(), open.pitch_deg};
}

/// Tries scales along the valley.
class ClosedTurn {
 public:
  /// `alignment`: has found the valley, and with it what is peculiar to each pixel and which readings to
  /// trust. It is laid out anew.
  ClosedTurn(const Valley& valley, const Layout& closed, Alignment& alignment)
      : valley_(valley), alignment_(alignment) {
    alignment_.lay_out(closed);
  }

  double variance(double at_scale) { return alignment_.variance(at(at_scale)); }
  std::vector<double> misfit(double at_scale) { return alignment_.misfit_at(at(at_scale)); }
  double readings() const { return alignment_.readings(); }
  void look_at_one_of(std::size_t stride) { alignment_.look_at_one_of(stride); }

 private:
  Parameters at(double at_scale) {
    Parameters parameters = valley_.parameters;
    parameters[scale] = at_scale;
    alignment_.set_pitch(valley_.pitch_deg(at_scale));
    return parameters;
  }

  Valley valley_;
  Alignment& alignment_;
};

struct Try {
  double scale = 1.0;
  double variance = 0.0;
};

/// So large a variance only `share` of the tries stay below.
double variance_of_share(const std::vector<Try>& tries, double share) {
  std::vector<double> variances;
  for (const Try& one : tries) variances.push_back(one.variance);
  const auto at =
      variances.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(variances.size()));
  std::nth_element(variances.begin(), at, variances.end());
  return *at;
}

/// From the one end of what the scale may be to the other, closely where coarse steps were sharpest. Where
/// the turn closes shows in a part of the halves too, and each try costs less.
std::vector<Try> search_scale(ClosedTurn& turn, std::size_t halves, double middle, double uncertainty,
                              double step) {
  const int steps = std::min(most_steps, static_cast<int>(searched_uncertainties * uncertainty / step) + 1);
  turn.look_at_one_of(std::max<std::size_t>(1, halves / searched_halves));
  const auto tried = [&](int i) { return Try{middle + i * step, turn.variance(middle + i * step)}; };
  std::vector<Try> tries;
  for (int i = -steps; i <= steps; i += coarse_steps) tries.push_back(tried(i));
  const double limit = variance_of_share(tries, coarse_share);
  const std::size_t coarse = tries.size();
  for (std::size_t k = 0; k < coarse; ++k) {
    if (tries[k].variance > limit && (k + 1 == coarse || tries[k + 1].variance > limit)) continue;
    const int from = -steps + static_cast<int>(k) * coarse_steps;
    for (int i = from + 1; i < from + coarse_steps && i <= steps; ++i) tries.push_back(tried(i));
  }
  turn.look_at_one_of(1);
  return tries;
}

/// The sharpest try of those that are at least so far from `other`.
Try sharpest(const std::vector<Try>& tries, double other, double distance) {
  Try best{other, std::numeric_limits<double>::max()};
  for (const Try& one : tries)
    if (std::abs(one.scale - other) >= distance && one.variance < best.variance) best = one;
  return best;
}

/// The lowest point near by, by parabolas through three tries, and its curvature.
std::optional<Estimate> lowest(ClosedTurn& turn, double tried, double step) {
  Estimate found{tried, 0.0};
  for (int round = 0; round < closing_rounds; ++round) {
    const double before = turn.variance(found.value - step), here = turn.variance(found.value),
                 after = turn.variance(found.value + step);
    const double bend = (before - 2.0 * here + after) / (step * step);
    if (!(bend > 0.0)) return std::nullopt;
    found.value += std::clamp((before - after) / (2.0 * bend * step), -step, step);
    found.uncertainty = repeated_readings * std::sqrt(2.0 * here / (turn.readings() * bend));
  }
  return found;
}

/// Sets one scale against others, by the halves that see what was seen a turn before or after.
class ScaleContest {
 public:
  ScaleContest(ClosedTurn& turn, double at_scale, const Window& window, const Evidence& evidence,
               double field_of_view_deg)
      : turn_(turn), at_scale_(at_scale), window_(window), misfit_(turn.misfit(at_scale)) {
    const Turned turned = turned_in(window, evidence);
    for (std::size_t i = 0; i < window.size(); ++i)
      if (turned.is_seen_twice(angle_deg(window[i], evidence), field_of_view_deg)) witnesses_.push_back(i);
  }

  /// How clearly it beats the other.
  double lead(double other_scale) {
    const std::vector<double> other = turn_.misfit(other_scale);
    Contest contest(glance_s);
    for (const std::size_t i : witnesses_)
      contest.add(std::span(window_).subspan(i, 1), std::span(misfit_).subspan(i, 1),
                  std::span(other).subspan(i, 1));
    return contest.lead();
  }

  /// Where single halves fit better at a scale too near to be another place, something that moves before the
  /// walls has shifted the whole panorama, and the scale is anywhere near by.
  double common_shift(double pixel) {
    const bool is_shifted = lead(at_scale_ - pixel) < 0.0 || lead(at_scale_ + pixel) < 0.0;
    return is_shifted ? apart_pixels / 2.0 * pixel : 0.0;
  }

 private:
  ClosedTurn& turn_;
  double at_scale_;
  const Window& window_;
  std::vector<double> misfit_;
  std::vector<std::size_t> witnesses_;
};

/// What an error of the bias adds up to over the window: a turn there and back takes most of it out.
double bias_share(const Window& window, const Valley& valley, double turned_deg) {
  const double length_s = window.back().end_s - window.front().begin_s;
  const double left = goes_both_ways(window) ? left_both_ways : 1.0;
  return left * valley.bias_uncertainty_dps * length_s / turned_deg;
}

/// The scale at which what is seen a turn later lies on what was seen before, if no other place fits as well.
std::optional<Estimate> scale_in(const Window& window, const Evidence& evidence, const View& view,
                                 double assumed_uncertainty, double turned_deg) {
  const Layout open = layout_of(view, false), closed = layout_of(view, true);
  std::vector<HalfView> views = views_of(window);
  Alignment alignment(views, evidence.track, open, evidence.prior);
  const Valley valley = find_valley(window, evidence, open, alignment);
  if (valley.contrast < least_scale_contrast) return std::nullopt;
  ClosedTurn turn(valley, closed, alignment);
  const double pixel =
      closed.pitch_deg / turned_deg;  // change of scale that moves the end of the turn by one
  const double step = step_pixels * pixel;
  const auto tries = search_scale(turn, window.size(), evidence.prior.mean[scale],
                                  std::max(assumed_uncertainty, apart_pixels * pixel), step);
  const Try best = sharpest(tries, 0.0, 0.0);
  const Try next = sharpest(tries, best.scale, apart_pixels * pixel);
  const auto found = lowest(turn, best.scale, step);
  if (!found || !(found->uncertainty < worst_uncertainty)) return std::nullopt;
  const Estimate other = lowest(turn, next.scale, step).value_or(Estimate{next.scale, 0.0});
  const bool is_elsewhere = std::abs(other.value - found->value) > pixel;
  ScaleContest contest(turn, found->value, window, evidence, view.field_of_view_deg);
  if (is_elsewhere && contest.lead(other.value) < clear_lead) return std::nullopt;
  const double shift = contest.common_shift(pixel);
  return Estimate{found->value,
                  std::hypot(std::hypot(found->uncertainty, shift), model_error_deg / turned_deg,
                             bias_share(window, valley, turned_deg))};
}

/// What the windows differ by beyond their own uncertainty: the scale that changes with the temperature.
double excess_spread(const std::vector<Estimate>& told) {
  RunningStatistics values;
  double explained = 0.0;
  for (const Estimate& one : told) {
    values.add(one.value);
    explained += one.uncertainty * one.uncertainty / static_cast<double>(told.size());
  }
  return std::sqrt(std::max(0.0, values.sample_variance() - explained));
}

/// Windows overlap by half: two of them hold little more than what one does.
Estimate overlapping_mean(const std::vector<Estimate>& told) {
  Estimate mean = weighted_mean(told);
  if (told.size() > 1) mean.uncertainty *= std::numbers::sqrt2;
  mean.uncertainty = std::max(mean.uncertainty, excess_spread(told));
  return mean;
}

}  // namespace

TurnResult gyro_scale(std::span<const TimedFrame> frames, std::span<const TimedGyro> gyro, const View& view,
                      const GyroErrors& errors, std::size_t most_windows, const RunAll& run_all) {
  Evidence evidence = gather(frames, gyro, view, errors);
  TurnResult result{.gyro_scale = {}, .turned_deg = 0.0, .why_not = evidence.why_not};
  if (!result.why_not.empty()) return result;
  const double assumed_uncertainty = evidence.prior.uncertainty[scale];
  evidence.prior.uncertainty[scale] = free_scale;
  const double needed_deg = whole_turn_deg - (1.0 - least_overlap) * view.field_of_view_deg;
  const std::vector<Window> windows = turning_windows(evidence.halves, most_windows);
  std::vector<std::optional<Estimate>> estimates(windows.size());
  std::vector<double> turned_deg;
  for (const Window& window : windows) {
    turned_deg.push_back(turned_in(window, evidence).span_deg());
    result.turned_deg = std::max(result.turned_deg, turned_deg.back());
  }
  run_all(windows.size(), [&](std::size_t i) {
    if (windows[i].size() < fewest_halves || turned_deg[i] < needed_deg || turned_deg[i] > most_turned_deg)
      return;
    estimates[i] = scale_in(windows[i], evidence, view, assumed_uncertainty, turned_deg[i]);
  });
  std::vector<Estimate> told;
  for (const auto& estimate : estimates)
    if (estimate) told.push_back(*estimate);
  if (!told.empty())
    result.gyro_scale = overlapping_mean(told);
  else if (result.turned_deg < needed_deg)
    result.why_not = "no turn closes: the rig turned through " +
                     std::to_string(std::lround(result.turned_deg)) + " of 360 degrees";
  else
    result.why_not = "too little image detail where the turn closes";
  return result;
}

}  // namespace thermorig::motion
