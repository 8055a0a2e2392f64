// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/measured_track.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "thermorig/core/statistics.h"

namespace thermorig::labels {

namespace {

// Either way of an instant, the narrowest first.
constexpr std::array reaches_s{0.0055, 0.0125, 0.025, MeasuredTrack::reach_s};
// A line holds where readings are as near as that to the instant, on either side.
constexpr double longest_silence_s = 0.03;
constexpr std::size_t fewest_points = 3;
constexpr double line_chance_deviations = 0.5;
constexpr double most_by_chance = 2.0;  // deviations
constexpr double bend_chance = 6.0;     // times the variance of a difference

/// A straight line through readings, at an instant.
struct Line {
  double angle_deg = 0.0;
  double own2 = 0.0;     // variance by the noise of the readings
  double strays2 = 0.0;  // by what readings stray beyond their noise, the shaft strays from a line
};

template <typename Points>
std::optional<Line> line_at(const Points& points, HostTime time) {
  LineFit fit;
  double noise2 = 0.0;
  for (const auto& point : points) {
    fit.add(to_s(point.time - time), point.angle_deg);
    noise2 += double{point.uncertainty_deg} * double{point.uncertainty_deg};
  }
  if (!(fit.squares_x() > 0.0)) return std::nullopt;
  noise2 /= fit.weights();
  const double free = fit.weights() - 2.0;
  const double explained2 = noise2 * (1.0 + line_chance_deviations * std::sqrt(2.0 / free));
  const double strays2 = std::max(0.0, fit.residual_squares() / free - explained2);
  const double own2 = noise2 * (1.0 / fit.weights() + fit.mean_x() * fit.mean_x() / fit.squares_x());
  return Line{fit.at(0.0), own2, strays2};
}

template <typename Point>
Estimate line_through(const Point& one, const Point& other, HostTime time) {
  const double part = to_s(time - one.time) / to_s(other.time - one.time);
  return {one.angle_deg + part * (other.angle_deg - one.angle_deg),
          std::hypot((1.0 - part) * double{one.uncertainty_deg}, part * double{other.uncertainty_deg})};
}

bool beyond_chance(const Estimate& off) {
  return std::abs(off.value) > most_by_chance * off.uncertainty;
}

/// How far a line is bent that a narrower one was cut from, squared.
double bent2(const Line& narrow, const Line& wide) {
  const double apart = wide.angle_deg - narrow.angle_deg;
  return apart * apart - bend_chance * std::max(0.0, narrow.own2 - wide.own2);
}

}  // namespace

void MeasuredTrack::add(const TimedShaft& shaft) {
  if (shaft.lost_before) ++lap_;
  if (!std::isfinite(shaft.angle_deg + double{shaft.reading.uncertainty_deg})) return;
  points_.add(
      {shaft.stamp.time, shaft.angle_deg, shaft.reading.uncertainty_deg, shaft.stamp.uncertainty_s, lap_});
}

/// By the window around it that says least of its own error. What a wide one differs by from a narrow one,
/// beyond chance, is how far the motion bends it.
std::optional<MeasuredTrack::At> MeasuredTrack::at(HostTime time) const {
  const auto points = points_.all();
  const std::size_t after = points_.first_at_or_after(time);
  if (after == 0 || after == points.size()) return std::nullopt;
  const Point &before = points[after - 1], &next = points[after];
  if (before.lap != next.lap) return std::nullopt;
  const bool asked = bridged_ > HostDuration::zero();
  std::optional<At> best = asked ? between_readings(time, after) : std::nullopt;
  if (std::max(time - before.time, next.time - time) > from_s(longest_silence_s)) return best;
  std::array<Line, reaches_s.size()> narrower;
  std::size_t count = 0;
  for (const double reach : reaches_s) {
    std::size_t first = after, last = after;
    while (first > 0 && points[first - 1].lap == next.lap && time - points[first - 1].time <= from_s(reach))
      --first;
    while (last < points.size() && points[last].lap == next.lap && points[last].time - time <= from_s(reach))
      ++last;
    if (last - first < fewest_points) continue;
    const auto line = line_at(points.subspan(first, last - first), time);
    if (!line) continue;
    double bend2 = 0.0;
    for (std::size_t i = 0; i < count; ++i) bend2 = std::max(bend2, bent2(narrower[i], *line));
    const double uncertainty_deg = std::sqrt(line->own2 + line->strays2 + bend2);
    if (!best || uncertainty_deg < best->angle_deg.uncertainty)
      best = At{{line->angle_deg, uncertainty_deg}, next.lap, next.time_uncertainty_s};
    narrower[count++] = *line;
  }
  return best;
}

/// A shaft that gains speed from one reading to the next, or loses it, passes between their chord and what
/// leads on to there from either side; one that does both, beyond chance, between the two that lead there. It
/// is taken to be half way. `after`: the first reading behind the instant.
std::optional<MeasuredTrack::At> MeasuredTrack::between_readings(HostTime time, std::size_t after) const {
  const auto points = points_.all();
  const Point &before = points[after - 1], &next = points[after];
  const auto go_on = [&](std::size_t i) {
    if (i + 1 >= points.size() || points[i].lap != points[i + 1].lap) return false;
    const HostDuration apart = points[i + 1].time - points[i].time;
    return apart > HostDuration::zero() && apart <= bridged_;
  };
  if (after < 2 || !go_on(after - 2) || !go_on(after - 1)) return std::nullopt;
  const Estimate chord = line_through(before, next, time);
  const auto off_chord = [&](const Point& one, const Point& other) {
    const Estimate line = line_through(one, other, time);
    return Estimate{line.value - chord.value, std::hypot(line.uncertainty, chord.uncertainty)};
  };
  const Estimate led = off_chord(points[after - 2], before);
  Estimate one = led, other{0.0, 0.0};  // the shaft passes between
  if (go_on(after)) {
    const Estimate came = off_chord(next, points[after + 1]);
    const bool contradict = led.value * came.value < 0.0;
    if (contradict && beyond_chance(led) && beyond_chance(came)) {
      other = came;
    } else {
      if (std::abs(came.value) < std::abs(led.value)) one = came;
      if (contradict) one.value = 0.0;
    }
  }
  const double apart_deg = one.value - other.value;
  const double own2 = one.uncertainty * one.uncertainty + other.uncertainty * other.uncertainty;
  return At{{chord.value + 0.5 * (one.value + other.value),
             std::sqrt(chord.uncertainty * chord.uncertainty + apart_deg * apart_deg / 8.0 + own2 / 3.0)},
            next.lap,
            next.time_uncertainty_s};
}

std::optional<Estimate> MeasuredTrack::angle_deg(HostTime time) const {
  const auto found = at(time);
  return found ? std::optional(found->angle_deg) : std::nullopt;
}

std::optional<Estimate> MeasuredTrack::rate_dps(HostTime begin, HostTime end) const {
  if (!(begin < end)) return std::nullopt;
  const auto from = at(begin), to = at(end);
  if (!from || !to || from->lap != to->lap) return std::nullopt;
  const double length_s = to_s(end - begin);
  return Estimate{(to->angle_deg.value - from->angle_deg.value) / length_s,
                  std::hypot(from->angle_deg.uncertainty, to->angle_deg.uncertainty) / length_s};
}

float MeasuredTrack::time_uncertainty_s(HostTime time) const {
  const auto points = points_.all();
  const std::size_t after = points_.first_at_or_after(time);
  return after < points.size() ? points[after].time_uncertainty_s : 0.0F;
}

}  // namespace thermorig::labels
