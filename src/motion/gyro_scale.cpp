// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "contest.h"
#include "thermorig/motion/panorama_fit.h"
#include "weighted_mean.h"
#include "windows.h"

namespace thermorig::motion {
namespace {

constexpr std::size_t most_windows = 8;
constexpr std::size_t fewest_halves = 40;
constexpr double whole_turn_deg = 360.0;
constexpr double least_overlap = 0.3;           // of the field of view, after a turn that just misses closing
constexpr double searched_uncertainties = 3.0;  // of the scale that is assumed
constexpr double free_scale = 0.1;              // the result owes nothing to that assumption
constexpr double step_bins = 0.5;               // that far the ends of the turn move from one try to the next
constexpr double apart_bins = 4.0;              // tries closer than that are the same place
constexpr double least_contrast = 0.1;
constexpr double worst_uncertainty = 0.01;
constexpr double glance_s = 0.25;         // few halves see the end of a turn: each pair is a witness
constexpr double model_error_deg = 0.15;  // a tenth of a pixel: lens and lag, seen differently at either end

double angle_deg(const FreshHalf& half, const AngleTrack& track, const Prior& prior) {
  const double middle_s = 0.5 * (half.begin_s + half.end_s);
  return (track.over(half.begin_s, half.end_s).angle_deg - prior.mean[bias_dps] * middle_s) /
         prior.mean[scale];
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

Turned turned_in(const Window& window, const AngleTrack& track, const Prior& prior) {
  Turned turned{std::numeric_limits<double>::max(), std::numeric_limits<double>::lowest()};
  for (const FreshHalf& half : window) {
    turned.lowest_deg = std::min(turned.lowest_deg, angle_deg(half, track, prior));
    turned.highest_deg = std::max(turned.highest_deg, angle_deg(half, track, prior));
  }
  return turned;
}

struct Try {
  double scale = 1.0;
  double variance = 0.0;
};

std::vector<Try> search_scale(Alignment& alignment, const Parameters& start, const Prior& prior,
                              double uncertainty, double step) {
  std::vector<Try> tries;
  const int steps = static_cast<int>(std::ceil(searched_uncertainties * uncertainty / step));
  for (int i = -steps; i <= steps; ++i) {
    Parameters parameters = start;
    parameters[scale] = prior.mean[scale] + i * step;
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

Closed close_at(const Window& window, const AngleTrack& track, const Layout& layout, const Prior& prior,
                Parameters start, double scale_tried) {
  std::vector<HalfView> views = views_of(window);
  Alignment alignment(views, track, layout, prior);
  start[scale] = scale_tried;
  alignment.refine(start, scale);
  return {alignment.parameters(), std::sqrt(alignment.covariance()[scale][scale]), alignment.contrast(),
          alignment.misfit()};
}

/// How clearly the one beats the other, by the halves that see what was seen a turn before or after.
double lead(const Closed& closed, const Closed& other, const Window& window, const AngleTrack& track,
            const Prior& prior, double field_of_view_deg) {
  const Turned turned = turned_in(window, track, prior);
  Contest contest(glance_s);
  for (std::size_t i = 0; i < window.size(); ++i)
    if (turned.is_seen_twice(angle_deg(window[i], track, prior), field_of_view_deg))
      contest.add(std::span(window).subspan(i, 1), std::span(closed.misfit).subspan(i, 1),
                  std::span(other.misfit).subspan(i, 1));
  return contest.lead();
}

/// Where camera and gyro belong together, turns taken for as many places: that works without the scale.
Parameters offset_of(const Window& window, const AngleTrack& track, const View& view, const Prior& prior) {
  const RateRange rates = rates_of(window);
  if (std::min(rates.positive_dps, -rates.negative_dps) < slowest_useful_dps) return prior.mean;
  std::vector<HalfView> views = views_of(window);
  Alignment alignment(views, track, layout_of(view, false), prior);
  return search_offset(alignment, prior);
}

std::optional<Estimate> scale_in(const Window& window, const AngleTrack& track, const View& view,
                                 const GyroErrors& errors, const Prior& known, double turned) {
  Prior prior = known;
  prior.uncertainty[scale] = free_scale;
  const Parameters start = offset_of(window, track, view, prior);
  const Layout layout = layout_of(view, true);
  std::vector<HalfView> views = views_of(window);
  Alignment alignment(views, track, layout, prior);
  const double bin_share = layout.pitch_deg / turned;  // one pixel at the end of the turn
  const double uncertainty = std::max(errors.scale.uncertainty, apart_bins * bin_share);
  const auto tries = search_scale(alignment, start, prior, uncertainty, step_bins * bin_share);
  const Try best = sharpest(tries, 0.0, 0.0);
  const Try next = sharpest(tries, best.scale, apart_bins * bin_share);
  const Closed closed = close_at(window, track, layout, prior, start, best.scale);
  const Closed other = close_at(window, track, layout, prior, start, next.scale);
  const bool is_other = std::abs(other.parameters[scale] - closed.parameters[scale]) > bin_share;
  if (is_other && lead(closed, other, window, track, prior, view.field_of_view_deg) < clear_lead)
    return std::nullopt;
  if (closed.contrast < least_contrast || !(closed.uncertainty < worst_uncertainty)) return std::nullopt;
  return Estimate{closed.parameters[scale], std::hypot(closed.uncertainty, model_error_deg / turned)};
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
  TurnResult result;
  const AngleTrack track(gyro);
  const double bias = likely_bias_dps(track, errors);
  const Prior prior = prior_of(errors, bias);
  const auto halves = fresh_halves(frames, track, bias, largest_offset_s);
  const double needed_deg = whole_turn_deg - (1.0 - least_overlap) * view.field_of_view_deg;
  std::vector<Estimate> told;
  bool closes = false;
  for (const Window& window : turning_windows(halves, most_windows)) {
    const double turned = turned_in(window, track, prior).span_deg();
    result.turned_deg = std::max(result.turned_deg, turned);
    if (window.size() < fewest_halves || turned < needed_deg) continue;
    closes = true;
    const auto estimate = scale_in(window, track, view, errors, prior, turned);
    if (estimate) told.push_back(*estimate);
  }
  if (!told.empty())
    result.gyro_scale = overlapping_mean(told);
  else if (gyro.empty())
    result.why_not = "there is no gyro";
  else if (halves.size() < fewest_halves)
    result.why_not = "too few images have a gyro around them";
  else if (!closes)
    result.why_not = "no turn closes: the rig turned through " +
                     std::to_string(std::lround(result.turned_deg)) + " of 360 degrees";
  else
    result.why_not = "the surroundings show too little where the turn closes";
  return result;
}

}  // namespace thermorig::motion
