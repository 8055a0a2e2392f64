// SPDX-License-Identifier: MIT
#include "thermorig/learning/study/evaluation.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "gain_statistics.h"
#include "thermorig/core/statistics.h"
#include "thermorig/estimators/errors.h"
#include "thermorig/estimators/table.h"

namespace thermorig::study {

namespace {

constexpr double outlier_dps = 30.0;

/// Collects errors; those that are not finite are left out.
class ErrorStatistics {
 public:
  void add(double error_dps);
  Errors errors(double label_scale_dps);

 private:
  estimators::RateErrors sums_;
  std::uint64_t outliers_ = 0;
  std::vector<double> magnitudes_;
};

/// Of the windows at one speed.
struct SpeedSums {
  std::uint64_t windows = 0;
  PerEstimator<estimators::RateErrors> errors;

  void add(const JudgedWindow& judged) {
    ++windows;
    for (const std::string& name : all_estimators()) {
      const double error_dps = double{judged.rate_dps[name]} - double{judged.label_dps};
      if (std::isfinite(error_dps)) errors[name].add(error_dps);
    }
  }

  SpeedErrors at(double rate_dps, double label_scale_dps) const {
    SpeedErrors speed{rate_dps, windows};
    for (const std::string& name : all_estimators()) speed.mse[name] = errors[name].mse(label_scale_dps);
    return speed;
  }
};

/// Legs of one speed have the same value; what a file adds to it in rounding must not part them.
double speed_key(float rate_dps) {
  return std::round(double{rate_dps} * 1000.0) / 1000.0 + 0.0;  // no -0
}

void ErrorStatistics::add(double error_dps) {
  if (!std::isfinite(error_dps)) return;
  sums_.add(error_dps);
  const double magnitude = std::abs(error_dps);
  outliers_ += magnitude > outlier_dps ? 1 : 0;
  magnitudes_.push_back(magnitude);
}

Errors ErrorStatistics::errors(double label_scale_dps) {
  if (magnitudes_.empty()) return {};
  std::sort(magnitudes_.begin(), magnitudes_.end());
  return {.windows = sums_.count(),
          .mse = sums_.mse(label_scale_dps),
          .rmse_dps = sums_.rmse_dps(),
          .median_dps = quantile(magnitudes_, 0.5),
          .p95_dps = quantile(magnitudes_, 0.95),
          .outlier_share = static_cast<double>(outliers_) / static_cast<double>(sums_.count()),
          .mean_error_dps = sums_.mean_dps()};
}

/// Errors by the commanded speed of the leg that a window's newest frame lies in.
std::vector<SpeedErrors> speed_errors(std::span<const JudgedWindow> judged,
                                      std::span<const network::Acquisition> acquisitions,
                                      double label_scale_dps) {
  std::map<double, SpeedSums> by_speed;
  for (const JudgedWindow& one : judged) {
    const float rate_dps = acquisitions[one.window.acquisition].leg_rate_dps[one.window.last];
    if (std::isfinite(one.label_dps) && std::isfinite(rate_dps)) by_speed[speed_key(rate_dps)].add(one);
  }
  std::vector<SpeedErrors> speeds;
  for (const auto& [rate_dps, sums] : by_speed) speeds.push_back(sums.at(rate_dps, label_scale_dps));
  return speeds;
}

constexpr double normal_median = 0.674489750196082;  // of the size of a normal error, in its deviations

double median_of(std::vector<double>& values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? unknown : quantile(values, 0.5);
}

/// A window that does not depend on the rate at all has an infinite bound.
bool has_bound(const JudgedWindow& one) {
  return one.bound_dps > 0.0F && std::isfinite(one.label_dps);
}

void add_estimator(std::span<const JudgedWindow> judged, const std::string& name, BoundErrors& errors) {
  std::vector<double> multiples;
  double squares = 0.0, bound_squares = 0.0;
  for (const JudgedWindow& one : judged) {
    const double error_dps = double{one.rate_dps[name]} - double{one.label_dps};
    if (!has_bound(one) || !std::isfinite(error_dps)) continue;
    const double bound_dps = double{one.bound_dps};
    multiples.push_back(std::abs(error_dps) / bound_dps);
    if (bound_dps >= BoundErrors::well_told_dps) continue;
    squares += error_dps * error_dps;
    bound_squares += bound_dps * bound_dps;
  }
  errors.median[name] = median_of(multiples) / normal_median;
  errors.well_told_rmse[name] = std::sqrt(squares / bound_squares);
}

/// Nothing where no window has a bound.
std::optional<BoundErrors> bound_errors(std::span<const JudgedWindow> judged) {
  BoundErrors errors;
  std::vector<double> bounds_dps;
  for (const JudgedWindow& one : judged)
    if (has_bound(one)) bounds_dps.push_back(double{one.bound_dps});
  if (bounds_dps.empty()) return std::nullopt;
  errors.windows = bounds_dps.size();
  errors.well_told = static_cast<std::uint64_t>(std::count_if(
      bounds_dps.begin(), bounds_dps.end(), [](double bound) { return bound < BoundErrors::well_told_dps; }));
  errors.median_dps = median_of(bounds_dps);
  for (const std::string& name : all_estimators()) add_estimator(judged, name, errors);
  return errors;
}

/// The time between the window's newest frame and the frame before.
double duration_of(const network::Window& window, const network::Acquisition& acquisition) {
  const std::size_t last = window.last;
  return last == 0 ? 0.0 : to_s(acquisition.time[last] - acquisition.time[last - 1]);
}

/// The angle error of one estimator, a point a window; point 0 is the beginning.
struct ErrorLine {
  estimators::AngleError error, settled;
  std::vector<double> points_deg{0.0};

  void add(double error_dps, double duration_s, bool is_settled) {
    if (std::isfinite(error_dps)) error.add(error_dps, duration_s);
    if (std::isfinite(error_dps) && is_settled) settled.add(error_dps, duration_s);
    points_deg.push_back(error.angle_deg());
  }
};

/// Angles since the beginning, a point a window; point 0 is the beginning.
struct Integral {
  std::vector<double> time_s{0.0};
  std::vector<double> commanded_deg{0.0};
  std::vector<ErrorLine> lines{all_estimators().size()};

  void add(const JudgedWindow& judged, double duration_s, bool is_settled) {
    const double label_dps = judged.label_dps;
    time_s.push_back(time_s.back() + duration_s);
    commanded_deg.push_back(commanded_deg.back() + label_dps * duration_s);
    for (std::size_t i = 0; i < lines.size(); ++i)
      lines[i].add(double{judged.rate_dps.values()[i]} - label_dps, duration_s, is_settled);
  }
};

double rounded(double value) {
  return std::round(value * 100.0) / 100.0;
}

/// At most `points` of the values, the first and the last among them.
std::vector<double> thinned(const std::vector<double>& values, std::size_t points) {
  std::vector<double> few;
  const std::size_t count = std::min(values.size(), std::max<std::size_t>(points, 2));
  for (std::size_t i = 0; i < count; ++i)
    few.push_back(rounded(values[count == 1 ? 0 : i * (values.size() - 1) / (count - 1)]));
  return few;
}

/// Integrates over the windows of one acquisition, in ascending order; at most so many points a line.
AngleTrack angle_track(std::span<const JudgedWindow> judged, const network::Acquisition& acquisition,
                       std::size_t points) {
  Integral integral;
  for (const JudgedWindow& one : judged) {
    const double duration_s = duration_of(one.window, acquisition);
    if (!std::isfinite(one.label_dps) || duration_s <= 0.0) continue;
    const double time_s = to_s(acquisition.time[one.window.last] - acquisition.time.front());
    integral.add(one, duration_s, time_s >= AngleTrack::settled_s);
  }
  AngleTrack track;
  track.integrated_s = integral.time_s.back();
  track.time_s = thinned(integral.time_s, points);
  track.commanded_deg = thinned(integral.commanded_deg, points);
  for (const std::string& name : all_estimators()) {
    const ErrorLine& line = integral.lines[place_of(name)];
    if (line.error.has_begun()) track.error_deg[name] = thinned(line.points_deg, points);
    track.drift_deg_per_min[name] = line.error.slope_deg_per_min();
    track.worst_deg[name] = line.error.worst_deg();
    track.settled_drift_deg_per_min[name] = line.settled.slope_deg_per_min();
    track.settled_worst_deg[name] = line.settled.worst_deg();
  }
  return track;
}

PerEstimator<Errors> errors_of(std::span<const JudgedWindow> judged, double label_scale_dps,
                               float JudgedWindow::*truth_dps = &JudgedWindow::label_dps) {
  PerEstimator<Errors> errors;
  for (const std::string& name : all_estimators()) {
    ErrorStatistics statistics;
    for (const JudgedWindow& one : judged)
      statistics.add(double{one.rate_dps[name]} - double{one.*truth_dps});
    errors[name] = statistics.errors(label_scale_dps);
  }
  return errors;
}

std::vector<EnvironmentErrors> errors_by_environment(std::span<const JudgedWindow> judged,
                                                     std::span<const network::Acquisition> acquisitions,
                                                     double label_scale_dps) {
  std::map<std::string, std::vector<JudgedWindow>> parts;
  std::map<std::string, std::size_t> counts;
  for (const network::Acquisition& acquisition : acquisitions) ++counts[acquisition.environment];
  for (const JudgedWindow& one : judged)
    parts[acquisitions[one.window.acquisition].environment].push_back(one);
  std::vector<EnvironmentErrors> environments;
  for (const auto& [name, count] : counts)
    environments.push_back({name, count, errors_of(parts[name], label_scale_dps),
                            errors_of(parts[name], label_scale_dps, &JudgedWindow::shaft_dps),
                            gate_sigma(parts[name])});
  return environments;
}

std::span<const JudgedWindow> part_of(std::span<const JudgedWindow> judged, std::size_t acquisition) {
  const auto of = [](const JudgedWindow& one) { return one.window.acquisition; };
  return {std::ranges::lower_bound(judged, acquisition, {}, of),
          std::ranges::upper_bound(judged, acquisition, {}, of)};
}

}  // namespace

Evaluation evaluate(std::span<const JudgedWindow> judged, std::span<const network::Acquisition> acquisitions,
                    const EvaluationConfig& config) {
  assert(config.label_scale_dps > 0.0);
  Evaluation evaluation;
  evaluation.errors = errors_of(judged, config.label_scale_dps);
  evaluation.shaft_errors = errors_of(judged, config.label_scale_dps, &JudgedWindow::shaft_dps);
  evaluation.environments = errors_by_environment(judged, acquisitions, config.label_scale_dps);
  evaluation.speeds = speed_errors(judged, acquisitions, config.label_scale_dps);
  evaluation.gain = gain_statistics(judged);
  evaluation.sigma = gate_sigma(judged);
  evaluation.bounds = bound_errors(judged);
  for (std::size_t i = 0; i < acquisitions.size(); ++i) {
    evaluation.angles.push_back(angle_track(part_of(judged, i), acquisitions[i], config.angle_points));
    evaluation.names.push_back(acquisitions[i].name);
    evaluation.simulated = evaluation.simulated || acquisitions[i].simulated;
  }
  return evaluation;
}

namespace {

constexpr std::size_t networks = 3;

std::vector<std::string> compared() {
  std::vector<std::string> names{std::string(thermal_name), std::string(fusion_name),
                                 std::string(kalman_fusion_name)};
  for (const estimators::Entry& entry : estimators::all_entries())
    if (!entry.needs_network) names.emplace_back(entry.name);
  return names;
}

}  // namespace

std::span<const std::string> all_estimators() {
  static const std::vector<std::string> names = compared();
  return names;
}

std::span<const std::string> baselines() {
  return all_estimators().subspan(networks);
}

std::size_t place_of(std::string_view name) {
  const auto names = all_estimators();
  const auto found = std::find(names.begin(), names.end(), name);
  assert(found != names.end());
  return static_cast<std::size_t>(found - names.begin());
}

}  // namespace thermorig::study
