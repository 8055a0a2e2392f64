// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "contest.h"
#include "evidence.h"
#include "thermorig/pipeline/motion/panorama_fit.h"
#include "weighted_mean.h"
#include "windows.h"

namespace thermorig::motion {
namespace {

constexpr std::size_t most_scale_windows = 8;
constexpr double least_overlap = 0.3;           // of the field of view, after a turn that just misses closing
constexpr double searched_uncertainties = 3.0;  // of the scale that is assumed
constexpr double free_scale = 0.1;              // the result owes nothing to that assumption
constexpr double step_pixels = 0.5;             // that far the ends of the turn move from one try to the next
constexpr double apart_pixels = 4.0;            // tries closer than that are the same place
constexpr int most_steps = 250;
constexpr double most_turned_deg = 18000.0;  // fifty turns in a window: not a rig
constexpr double least_scale_contrast = 0.1;
constexpr double worst_uncertainty = 0.01;
constexpr double glance_s = 0.25;         // few halves see the end of a turn: each pair is a witness
constexpr double model_error_deg = 0.15;  // a tenth of a pixel: lens and lag, seen differently at either end

double angle_deg(const FreshHalf& half, const Evidence& evidence) {
  const Parameters& known = evidence.prior.mean;
  return (evidence.track.over(half.begin_s, half.end_s).angle_deg - known[bias_dps] * half.middle_s()) /
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

struct Try {
  double scale = 1.0;
  double variance = 0.0;
};

/// From the one end of what the scale may be to the other.
std::vector<Try> search_scale(Alignment& alignment, const Parameters& start, double uncertainty,
                              double step) {
  const int steps = std::min(most_steps, static_cast<int>(searched_uncertainties * uncertainty / step) + 1);
  std::vector<Try> tries;
  for (int i = -steps; i <= steps; ++i) {
    Parameters parameters = start;
    parameters[scale] += i * step;
    tries.push_back({parameters[scale], alignment.variance(parameters)});
  }
  return tries;
}

/// The sharpest try of those that are at least so far from `other`.
Try sharpest(const std::vector<Try>& tries, double other, double distance) {
  Try best{other, std::numeric_limits<double>::max()};
  for (const Try& one : tries)
    if (std::abs(one.scale - other) >= distance && one.variance < best.variance) best = one;
  return best;
}

struct Closed {
  Parameters parameters{};
  double uncertainty = 0.0;
  double contrast = 0.0;
  std::vector<double> misfit;
};

Closed close_at(const Window& window, const Evidence& evidence, const Layout& layout, Parameters start,
                double scale_tried) {
  std::vector<HalfView> views = views_of(window);
  Alignment alignment(views, evidence.track, layout, evidence.prior);
  start[scale] = scale_tried;
  alignment.refine(start, scale);
  return {alignment.parameters(), alignment.uncertainty(scale), alignment.contrast(), alignment.misfit()};
}

/// How clearly the one beats the other, by the halves that see what was seen a turn before or after.
double lead(const Closed& closed, const Closed& other, const Window& window, const Evidence& evidence,
            double field_of_view_deg) {
  const Turned turned = turned_in(window, evidence);
  Contest contest(glance_s);
  for (std::size_t i = 0; i < window.size(); ++i)
    if (turned.is_seen_twice(angle_deg(window[i], evidence), field_of_view_deg))
      contest.add(std::span(window).subspan(i, 1), std::span(closed.misfit).subspan(i, 1),
                  std::span(other.misfit).subspan(i, 1));
  return contest.lead();
}

/// Where camera and gyro belong together, turns taken for as many places: that works without the scale.
Parameters offset_of(const Window& window, const Evidence& evidence, const View& view) {
  const RateRange rates = rates_of(window);
  if (std::min(rates.positive_dps, -rates.negative_dps) < slowest_useful_dps) return evidence.prior.mean;
  std::vector<HalfView> views = views_of(window);
  return Alignment(views, evidence.track, layout_of(view, false), evidence.prior).search_offset();
}

/// The scale at which what is seen a turn later lies on what was seen before, if no other place fits as well.
std::optional<Estimate> scale_in(const Window& window, const Evidence& evidence, const View& view,
                                 double assumed_uncertainty, double turned_deg) {
  const Layout layout = layout_of(view, true);
  const Parameters start = offset_of(window, evidence, view);
  std::vector<HalfView> views = views_of(window);
  Alignment alignment(views, evidence.track, layout, evidence.prior);
  const double pixel =
      layout.pitch_deg / turned_deg;  // change of scale that moves the end of the turn by one
  const auto tries = search_scale(alignment, start, std::max(assumed_uncertainty, apart_pixels * pixel),
                                  step_pixels * pixel);
  const Try best = sharpest(tries, 0.0, 0.0);
  const Try next = sharpest(tries, best.scale, apart_pixels * pixel);
  const Closed closed = close_at(window, evidence, layout, start, best.scale);
  const Closed other = close_at(window, evidence, layout, start, next.scale);
  const bool is_elsewhere = std::abs(other.parameters[scale] - closed.parameters[scale]) > pixel;
  if (is_elsewhere && lead(closed, other, window, evidence, view.field_of_view_deg) < clear_lead)
    return std::nullopt;
  if (closed.contrast < least_scale_contrast || !(closed.uncertainty < worst_uncertainty))
    return std::nullopt;
  return Estimate{closed.parameters[scale], std::hypot(closed.uncertainty, model_error_deg / turned_deg)};
}

/// Windows overlap by half: two of them hold little more than what one does.
Estimate overlapping_mean(const std::vector<Estimate>& told) {
  Estimate mean = weighted_mean(told);
  if (told.size() > 1) mean.uncertainty *= std::numbers::sqrt2;
  return mean;
}

}  // namespace

TurnResult gyro_scale(std::span<const TimedFrame> frames, std::span<const TimedGyro> gyro, const View& view,
                      const GyroErrors& errors) {
  Evidence evidence = gather(frames, gyro, view, errors);
  TurnResult result{.gyro_scale = {}, .turned_deg = 0.0, .why_not = evidence.why_not};
  if (!result.why_not.empty()) return result;
  const double assumed_uncertainty = evidence.prior.uncertainty[scale];
  evidence.prior.uncertainty[scale] = free_scale;
  const double needed_deg = whole_turn_deg - (1.0 - least_overlap) * view.field_of_view_deg;
  std::vector<Estimate> told;
  for (const Window& window : turning_windows(evidence.halves, most_scale_windows)) {
    const double turned_deg = turned_in(window, evidence).span_deg();
    result.turned_deg = std::max(result.turned_deg, turned_deg);
    if (window.size() < fewest_halves || turned_deg < needed_deg || turned_deg > most_turned_deg) continue;
    const auto estimate = scale_in(window, evidence, view, assumed_uncertainty, turned_deg);
    if (estimate) told.push_back(*estimate);
  }
  if (!told.empty())
    result.gyro_scale = overlapping_mean(told);
  else if (result.turned_deg < needed_deg)
    result.why_not = "no turn closes: the rig turned through " +
                     std::to_string(std::lround(result.turned_deg)) + " of 360 degrees";
  else
    result.why_not = "the surroundings show too little where the turn closes";
  return result;
}

}  // namespace thermorig::motion
