// SPDX-License-Identifier: MIT
#include "angle_integral.h"

#include <algorithm>
#include <cmath>

#include "thermorig/estimators/errors.h"

namespace thermorig::study {

namespace {

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

}  // namespace

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

}  // namespace thermorig::study
