// SPDX-License-Identifier: MIT
#include "segments.h"

#include <cmath>

namespace thermorig::timing {

namespace {
constexpr double no_clock_s = 1e9;

bool is_clock(double device_s) {
  return std::isfinite(device_s) && std::abs(device_s) < no_clock_s;
}

/// Inequalities come in the order of the messages: those of a segment are the next ones, as long as they do
/// not step back and lie within it.
std::size_t end_of_latest(std::span<const LatestBegin> latest, std::size_t begin, double last_s) {
  std::size_t end = begin;
  double before_s = -no_clock_s;
  for (; end < latest.size(); ++end) {
    const double device_s = latest[end].device_s;
    if (!is_clock(device_s) || device_s < before_s || device_s > last_s) break;
    before_s = device_s;
  }
  return end;
}
}  // namespace

std::vector<double> clean_device_s(std::span<const double> device_s) {
  std::vector<double> clean(device_s.begin(), device_s.end());
  double before_s = 0.0;
  for (const double value : device_s)
    if (is_clock(value)) {
      before_s = value;
      break;
    }
  for (double& value : clean) before_s = value = is_clock(value) ? value : before_s;
  return clean;
}

std::vector<Segment> find_segments(std::span<const double> device_s, std::span<const LatestBegin> latest,
                                   double longest_gap_s) {
  std::vector<Segment> segments;
  for (std::size_t i = 0; i < device_s.size(); ++i) {
    const double step_s = i == 0 ? 0.0 : device_s[i] - device_s[i - 1];
    if (i == 0 || step_s < 0.0 || step_s > longest_gap_s)
      segments.push_back({.begin = i, .end = i, .new_epoch = step_s < 0.0});
    segments.back().end = i + 1;
  }
  std::size_t next = 0;
  for (Segment& segment : segments) {
    segment.latest_begin = next;
    next = segment.latest_end = end_of_latest(latest, next, device_s[segment.end - 1]);
  }
  return segments;
}

}  // namespace thermorig::timing
