// SPDX-License-Identifier: MIT
#include "gain_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "least_squares.h"
#include "reached_speeds.h"
#include "ripple_search.h"
#include "thermorig/core/statistics.h"
#include "thermorig/pipeline/labels/pulse_train.h"
#include "thermorig/pipeline/labels/servo_model.h"

namespace thermorig::fit {

using labels::pulse_period_s, labels::ShaftSlope;

namespace {
constexpr std::size_t knots = 17;
constexpr std::size_t bias = knots;          // of the unknowns: the gyro's
constexpr std::size_t unknowns = knots + 1;  // then four a ripple: forward and backward, cosine and sine
constexpr int parts_a_window = 5;            // of a window: pulse periods
constexpr double slowest_dps = 3.0;          // below it a window says little
constexpr double bend_deviation = 0.004;     // of a knot from the middle of its neighbours
constexpr double gain_deviation = 0.05;      // of a knot from 1: a servo is no worse
constexpr double ripple_deviation = 0.03;    // of a ripple's parts from 0
constexpr double least_ripple = 0.001;       // of the speed; smaller ones matter to nobody
constexpr std::size_t most_searches = 6;
constexpr double first_deviation_dps = 0.5;
constexpr double least_deviation_dps = 0.03;
constexpr double outlying = 5.0;
constexpr double least_ratio_error = 3e-4;  // what the model lacks does not average out for ever
constexpr std::size_t least_windows = 20;

// A bias that moves shows in stretches in which the shaft turned both ways.
constexpr double stretch_s = 30.0;
constexpr double most_one_way = 0.3;          // of a stretch's mean speed
constexpr std::size_t least_of_stretch = 60;  // windows
constexpr double moved_dps = 0.1;             // less is left in the bias's uncertainty

struct Window {
  double middle_s = 0.0;
  std::span<const double> row;
  double rate_dps = 0.0;  // by the gyro
};

/// Their rows lie in one array: windows may be dropped and copied, but not outlive it.
struct Windows {
  std::vector<double> rows;
  std::vector<Window> all;
};

/// Where in the row a commanded value lies, and how much of it falls to the right knot.
struct Place {
  std::size_t left;
  double share;
};
Place place_of(const PulseScale& scale, double value) {
  // fmin and fmax: a value that is not a number has a place as well.
  const double part = std::fmax(0.0, std::fmin((scale.part(value) + 1.0) / 2.0, 1.0));
  const double place = part * static_cast<double>(knots - 1);
  const auto left = std::min(static_cast<std::size_t>(place), knots - 2);
  return {left, place - static_cast<double>(left)};
}

/// Where the shaft's angle is by a fit, and which ripples are asked for.
struct Ripples {
  ShaftSlope slope;
  std::span<const double> periods_deg;

  std::size_t row_size() const { return unknowns + 4 * periods_deg.size(); }

  /// Of the shaft where its loop is at that angle, in each of the ripples.
  void put_phases(double angle_deg, std::vector<RipplePhase>& phases) const {
    phases.clear();
    if (periods_deg.empty()) return;
    const double gained_deg = slope.gained_deg(angle_deg);
    for (const double period_deg : periods_deg) phases.emplace_back(gained_deg, period_deg);
  }

  void add_to(std::span<double> row, const std::vector<RipplePhase>& from, const std::vector<RipplePhase>& to,
              bool forward) const {
    for (std::size_t k = 0; k < periods_deg.size(); ++k) {
      const auto [cosine, sine] = ripple_turned_deg(from[k], to[k], periods_deg[k]);
      const std::size_t first = unknowns + 4 * k + (forward ? 0 : 2);
      row[first] += cosine / (parts_a_window * pulse_period_s);
      row[first + 1] += sine / (parts_a_window * pulse_period_s);
    }
  }
};

/// What is kept from one row to the next: how far the curve was looked through, and room for phases.
struct RowWalk {
  std::size_t near = 0;
  std::vector<RipplePhase> before, now;
};

/// What the model says of a window, put into a row of zeros.
void put_row(const ShaftEvidence& evidence, double model_s, const Ripples& ripples, RowWalk& walk,
             std::span<double> row) {
  double before_deg = evidence.curve.angle_deg(model_s, walk.near);
  ripples.put_phases(before_deg, walk.before);
  for (int part = 1; part <= parts_a_window; ++part) {
    const double angle_deg = evidence.curve.angle_deg(model_s + part * pulse_period_s, walk.near);
    ripples.put_phases(angle_deg, walk.now);
    const double turned_deg = angle_deg - before_deg;
    const double value =
        evidence.scale.continuous() ? turned_deg / pulse_period_s : (before_deg + angle_deg) / 2.0;
    const auto [left, share] = place_of(evidence.scale, value);
    row[left] += (1.0 - share) * turned_deg / (parts_a_window * pulse_period_s);
    row[left + 1] += share * turned_deg / (parts_a_window * pulse_period_s);
    ripples.add_to(row, walk.before, walk.now, angle_deg > before_deg);
    before_deg = angle_deg;
    std::swap(walk.before, walk.now);
  }
  row[bias] = 1.0;
}

double model_dps(std::span<const double> row) {
  return std::accumulate(row.begin(), row.begin() + knots, 0.0);
}

Windows windows(const ShaftEvidence& evidence, const Ripples& ripples) {
  constexpr double length_s = parts_a_window * pulse_period_s;
  // No more than there are samples to fill them: the times of a damaged recording may lie ages apart.
  const auto samples = static_cast<double>(evidence.gyro.times_s().size());
  const auto count =
      static_cast<std::size_t>(std::clamp((evidence.end_s - evidence.begin_s) / length_s, 0.0, samples));
  const std::size_t size = ripples.row_size();
  Windows found;
  found.rows.resize(count * size);
  RowWalk walk;
  std::size_t near_gyro = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double from_s = evidence.begin_s + static_cast<double>(i) * length_s;
    const auto row = std::span(found.rows).subspan(i * size, size);
    put_row(evidence, from_s - evidence.delay_s, ripples, walk, row);
    if (std::abs(model_dps(row)) < slowest_dps || is_within(evidence.strayed, from_s)) continue;
    const double rate_dps = evidence.gyro.mean_dps(from_s, from_s + length_s, near_gyro);
    if (std::isfinite(rate_dps)) found.all.push_back({from_s + length_s / 2.0, row, rate_dps});
  }
  return found;
}

LeastSquares equations_of(const std::vector<Window>& windows, double deviation_dps,
                          double bias_uncertainty_dps) {
  const std::size_t size = windows.front().row.size();
  LeastSquares equations(size);
  for (const Window& window : windows) equations.add(window.row, window.rate_dps, deviation_dps);
  for (std::size_t i = unknowns; i < size; ++i) equations.add_prior(i, 0.0, ripple_deviation);
  for (std::size_t i = 0; i < knots; ++i) equations.add_prior(i, 1.0, gain_deviation);
  constexpr std::array<double, 3> bend{-0.5, 1.0, -0.5};
  for (std::size_t i = 0; i + 2 < knots; ++i) equations.add_part(i, bend, 0.0, bend_deviation);
  equations.add_prior(bias, 0.0, std::max(bias_uncertainty_dps, 1e-3));
  return equations;
}

double residual_dps(const Window& window, const std::vector<double>& x) {
  return window.rate_dps - std::inner_product(x.begin(), x.end(), window.row.begin(), 0.0);
}

std::vector<double> residuals_dps(const std::vector<Window>& windows, const std::vector<double>& x) {
  std::vector<double> residuals;
  residuals.reserve(windows.size());
  for (const Window& window : windows) residuals.push_back(residual_dps(window, x));
  return residuals;
}

/// How much of the motion fell to each knot; sums to 1.
std::vector<double> visits(const std::vector<Window>& windows) {
  std::vector<double> weights(windows.front().row.size(), 0.0);
  double sum = 0.0;
  for (const Window& window : windows)
    for (std::size_t i = 0; i < knots; ++i) {
      weights[i] += std::abs(window.row[i]);
      sum += std::abs(window.row[i]);
    }
  for (double& weight : weights) weight /= sum;
  return weights;
}
using Course = std::vector<std::pair<double, double>>;

double course_at(const Course& course, double time_s) {
  if (course.empty()) return 0.0;
  const auto next = std::lower_bound(course.begin(), course.end(), time_s,
                                     [](const auto& knot, double time) { return knot.first < time; });
  if (next == course.begin()) return course.front().second;
  if (next == course.end()) return course.back().second;
  const auto before = next - 1;
  return std::lerp(before->second, next->second, (time_s - before->first) / (next->first - before->first));
}

/// Windows of one stretch of time, what the fit leaves of them, and how evenly they went both ways.
struct Stretch {
  std::vector<double> residuals;
  double sum_dps = 0.0, sum_abs_dps = 0.0, sum_s = 0.0;

  void add(const Window& window, double residual) {
    const double rate_dps = model_dps(window.row);
    residuals.push_back(residual);
    sum_dps += rate_dps;
    sum_abs_dps += std::abs(rate_dps);
    sum_s += window.middle_s;
  }
  bool tells() const {
    return residuals.size() >= least_of_stretch && std::abs(sum_dps) < most_one_way * sum_abs_dps;
  }
};

/// How the bias moved about what the fit found, if it did by more than `moved_dps`.
Course course_of(const std::vector<Window>& windows, const std::vector<double>& x) {
  Course course;
  Stretch stretch;
  double from_s = windows.front().middle_s, squares = 0.0;
  const auto close = [&] {
    if (stretch.tells()) {
      const auto count = static_cast<double>(stretch.residuals.size());
      const double left_dps = median(std::move(stretch.residuals));
      course.emplace_back(stretch.sum_s / count, left_dps);
      squares += left_dps * left_dps;
    }
    stretch = {};
  };
  for (const Window& window : windows) {
    if (window.middle_s > from_s + stretch_s) {
      close();
      from_s = window.middle_s;
    }
    stretch.add(window, residual_dps(window, x));
  }
  close();
  const bool moved =
      course.size() > 1 && squares > moved_dps * moved_dps * static_cast<double>(course.size());
  return moved ? course : Course{};
}

/// The equations of the windows that belong together; those that do not are dropped. None: too few are left.
std::optional<LeastSquares> equations_without_outliers(std::vector<Window>& used,
                                                       double bias_uncertainty_dps) {
  constexpr int rounds = 3;
  if (used.size() < least_windows) return std::nullopt;
  LeastSquares equations = equations_of(used, first_deviation_dps, bias_uncertainty_dps);
  for (int round = 0; round < rounds; ++round) {
    const std::vector<double> x = equations.solve();
    const double deviation_dps = std::max(robust_deviation(residuals_dps(used, x), 0.0), least_deviation_dps);
    const double limit = outlying * deviation_dps;
    std::erase_if(used, [&](const Window& window) { return std::abs(residual_dps(window, x)) > limit; });
    if (used.size() < least_windows) return std::nullopt;
    equations = equations_of(used, deviation_dps, bias_uncertainty_dps);
  }
  return equations;
}

/// Share of the speed, in the direction in which it is larger.
double size_of(const ServoResponse::Ripple& ripple) {
  return std::max(std::hypot(ripple.forward_cosine, ripple.forward_sine),
                  std::hypot(ripple.backward_cosine, ripple.backward_sine));
}

}  // namespace

double GainFit::bias_at(double time_s) const {
  return bias_dps + course_at(bias_course, time_s);
}

std::optional<GainFit> fit_gain(const ShaftEvidence& evidence, double bias_uncertainty_dps,
                                std::span<const double> ripple_periods_deg, const GainFit& before) {
  const Ripples ripples{ShaftSlope(before.gain, {}, evidence.scale), ripple_periods_deg};
  const Windows found = windows(evidence, ripples);
  std::vector<Window> used = found.all;
  std::optional<LeastSquares> equations = equations_without_outliers(used, bias_uncertainty_dps);
  if (!equations) return std::nullopt;
  std::vector<double> x = equations->solve();
  GainFit fit;
  fit.bias_course = course_of(found.all, x);
  if (!fit.bias_course.empty()) {
    used = found.all;
    for (Window& window : used) window.rate_dps -= course_at(fit.bias_course, window.middle_s);
    equations = equations_without_outliers(used, bias_uncertainty_dps);
    if (!equations) return std::nullopt;
    x = equations->solve();
  }
  const std::vector<double> weights = visits(used);
  fit.ratio.value = std::inner_product(weights.begin(), weights.end(), x.begin(), 0.0);
  fit.ratio.uncertainty = std::hypot(std::sqrt(equations->variance(weights)), least_ratio_error);
  fit.bias_dps = x[bias];
  for (std::size_t i = 0; i < knots; ++i) fit.gain.push_back(x[i] / fit.ratio.value);
  for (std::size_t k = 0; k < ripple_periods_deg.size(); ++k) {
    const auto part = [&](std::size_t i) { return x[unknowns + 4 * k + i] / fit.ratio.value; };
    fit.ripples.push_back({ripple_periods_deg[k], part(0), part(1), part(2), part(3)});
  }
  return fit;
}

std::optional<GainFit> fit_gain_and_ripples(const ShaftEvidence& evidence, double bias_uncertainty_dps) {
  std::optional<GainFit> fit = fit_gain(evidence, bias_uncertainty_dps);
  for (std::size_t search = 0; fit && search < most_searches; ++search) {
    const std::optional<double> period_deg = strongest_ripple_deg(evidence, *fit);
    if (!period_deg) break;
    std::vector<double> periods_deg;
    for (const ServoResponse::Ripple& ripple : fit->ripples) periods_deg.push_back(ripple.period_deg);
    periods_deg.push_back(*period_deg);
    std::optional<GainFit> more = fit_gain(evidence, bias_uncertainty_dps, periods_deg, *fit);
    if (!more || size_of(more->ripples.back()) < least_ripple) break;
    // One that stood for another, which is known now, has nothing left to explain.
    std::erase_if(more->ripples, [](const auto& ripple) { return size_of(ripple) < least_ripple; });
    fit = std::move(more);
  }
  return fit;
}

}  // namespace thermorig::fit
