// SPDX-License-Identifier: MIT
#include "angle_integral.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "estimates.h"
#include "thermorig/core/estimate.h"

namespace thermorig::study {

namespace {

using training::WindowEstimate;

constexpr double seconds_a_minute = 60.0;

/// What one window adds.
struct Step {
  double duration_s = 0.0;
  double label_dps = 0.0;
  std::array<double, estimator_count> error_dps{};
};

/// The time between the window's newest frame and the frame before.
double duration_of(const WindowEstimate& estimate, std::span<const windows::Acquisition> acquisitions) {
  const std::vector<HostTime>& time = acquisitions[estimate.window.acquisition].time;
  const std::size_t last = estimate.window.last;
  return last == 0 ? 0.0 : to_s(time[last] - time[last - 1]);
}

std::vector<Step> steps_of(std::span<const WindowEstimate> estimates,
                           std::span<const windows::Acquisition> acquisitions, bool fusion) {
  std::vector<Step> steps;
  for (const WindowEstimate& estimate : estimates) {
    Step step{duration_of(estimate, acquisitions), estimate.label_dps, {}};
    if (!std::isfinite(step.label_dps) || step.duration_s <= 0.0) continue;
    for (const Estimator estimator : all_estimators)
      step.error_dps[index_of(estimator)] =
          speed_of(estimate, estimator, acquisitions, fusion) - step.label_dps;
    steps.push_back(step);
  }
  return steps;
}

/// Those that say anything at all in this acquisition.
std::array<bool, estimator_count> present_in(const std::vector<Step>& steps) {
  std::array<bool, estimator_count> present{};
  for (const Step& step : steps)
    for (std::size_t i = 0; i < estimator_count; ++i)
      present[i] = present[i] || std::isfinite(step.error_dps[i]);
  return present;
}

bool complete(const Step& step, const std::array<bool, estimator_count>& present) {
  for (std::size_t i = 0; i < estimator_count; ++i)
    if (present[i] && !std::isfinite(step.error_dps[i])) return false;
  return true;
}

/// Angles since the beginning, a point a step; point 0 is the beginning.
struct Integral {
  std::vector<double> time_s{0.0};
  std::vector<double> commanded_deg{0.0};
  std::array<std::vector<double>, estimator_count> error_deg;

  explicit Integral(const std::array<bool, estimator_count>& present) {
    for (std::size_t i = 0; i < estimator_count; ++i)
      if (present[i]) error_deg[i].push_back(0.0);
  }

  void add(const Step& step) {
    time_s.push_back(time_s.back() + step.duration_s);
    commanded_deg.push_back(commanded_deg.back() + step.label_dps * step.duration_s);
    for (std::size_t i = 0; i < estimator_count; ++i)
      if (!error_deg[i].empty())
        error_deg[i].push_back(error_deg[i].back() + step.error_dps[i] * step.duration_s);
  }
};

/// Slope of the straight line through 0 that fits best, in deg/min.
double drift_of(const std::vector<double>& time_s, const std::vector<double>& error_deg) {
  double products = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < error_deg.size(); ++i) {
    products += time_s[i] * error_deg[i];
    squares += time_s[i] * time_s[i];
  }
  return error_deg.empty() || squares == 0.0 ? unknown : seconds_a_minute * products / squares;
}

double worst_of(const std::vector<double>& error_deg) {
  double worst = error_deg.empty() ? unknown : 0.0;
  for (const double error : error_deg) worst = std::max(worst, std::abs(error));
  return worst;
}

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

AngleTrack track_of(const Integral& integral, std::size_t points) {
  AngleTrack track;
  track.integrated_s = integral.time_s.back();
  track.time_s = thinned(integral.time_s, points);
  track.commanded_deg = thinned(integral.commanded_deg, points);
  for (std::size_t i = 0; i < estimator_count; ++i) {
    track.error_deg[i] = thinned(integral.error_deg[i], points);
    track.drift_deg_per_min[i] = drift_of(integral.time_s, integral.error_deg[i]);
    track.worst_deg[i] = worst_of(integral.error_deg[i]);
  }
  return track;
}

}  // namespace

AngleTrack angle_track(std::span<const WindowEstimate> estimates,
                       std::span<const windows::Acquisition> acquisitions, const EvaluationConfig& config) {
  const std::vector<Step> steps = steps_of(estimates, acquisitions, config.fusion);
  const std::array<bool, estimator_count> present = present_in(steps);
  Integral integral(present);
  for (const Step& step : steps)
    if (complete(step, present)) integral.add(step);
  return track_of(integral, config.angle_points);
}

}  // namespace thermorig::study
