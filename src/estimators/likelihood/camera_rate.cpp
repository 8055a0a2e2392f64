// SPDX-License-Identifier: MIT
#include "thermorig/estimators/likelihood/camera_rate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "pixel_errors.h"
#include "speed_search.h"

namespace thermorig::likelihood {

namespace {

constexpr double most_gap = 0.2;               // between two halves, of an exposure: they follow each other
constexpr double first_noise_variance = 0.36;  // of a reading: a data sheet's 0.6 K until windows have told
constexpr double least_noise_variance = 1e-4, noise_share = 0.05;
constexpr double most_misfit = 2.0;  // that a window's noise counts with
constexpr double moving_dps = 10.0;
// Of a rate: times of the exposures, the pitch of a pixel. Of all: what a shaft shakes.
constexpr double rate_share = 0.004, least_sigma_dps = 0.2;

/// A half that was read anew.
struct Half {
  HalfLines lines{};
  unsigned parity = 0;
  HostTime begin{}, end{};
  HostTime frame_end{};  // of the frame that brought it
};

}  // namespace

struct CameraRate::Parts {
  Parts(const CameraProfile& camera, int window_frames)
      : pitch_deg(camera.lens_width_deg() / static_cast<double>(frame_columns)),
        direction(camera.mirrored ? -1.0 : 1.0),
        frames(std::clamp(window_frames, 1, most_window_frames)) {
    const auto new_ones = static_cast<std::size_t>(frames - 1);  // of one half a frame, or of two
    for (const std::size_t read : {2 + new_ones, std::min(most_halves, 2 + 2 * new_ones)})
      SpeedTable::of(read);
  }

  bool take(const TimedFrame& frame, unsigned parity);
  bool follows(const TimedFrame& frame, unsigned parity) const;
  std::size_t halves_of_window() const;
  double step_s(std::size_t wanted) const;
  SpeedPosterior posterior(const Half& oldest, double step, double speed_dps);
  double sigma_dps(const SpeedPosterior& found, double speed_dps) const;
  void look(std::size_t count, CameraRateReport& report);

  double pitch_deg, direction;
  int frames;
  PixelErrors errors;
  WindowLines lines{most_halves};
  SpeedSearch search;
  EarlierRates earlier;
  double noise_variance = first_noise_variance;
  std::array<Half, most_halves> halves;                 // the newest is the last one
  std::size_t count = 0;                                // of those, in a row
  std::array<std::size_t, most_window_frames> fresh{};  // halves of the last frames, the newest last
  int in_a_row = 0;                                     // frames, at most so many
};

bool CameraRate::Parts::follows(const TimedFrame& frame, unsigned parity) const {
  if (count == 0) return false;
  const Half& last = halves.back();
  const double gap_s = to_s(frame.half[parity].begin - last.end);
  return parity != last.parity && std::abs(gap_s) <= most_gap * to_s(last.end - last.begin);
}

/// Returns whether its readings are.
bool CameraRate::Parts::take(const TimedFrame& frame, unsigned parity) {
  if (!follows(frame, parity)) count = 0;
  std::rotate(halves.begin(), halves.begin() + 1, halves.end());
  Half& half = halves.back();
  half.parity = parity;
  half.begin = frame.half[parity].begin;
  half.end = frame.half[parity].end;
  half.frame_end = frame.exposure_end;
  const bool is_clean = errors.clean(frame.frame, parity, half.lines);
  count = is_clean ? std::min(count + 1, most_halves) : 0;
  return is_clean;
}

/// The oldest frame of a window shows two halves, however many of them were new in it.
std::size_t CameraRate::Parts::halves_of_window() const {
  std::size_t halves_read = 2;
  for (int i = 1; i < frames; ++i) halves_read += fresh[fresh.size() - static_cast<std::size_t>(i)];
  return std::min(halves_read, most_halves);
}

/// From one half of the window to the next. Exposures are as long as the rate that the camera is set to makes
/// them; how frames really follow each other, their times tell: a camera is easily 2 % slower.
double CameraRate::Parts::step_s(std::size_t wanted) const {
  const std::span window = std::span(halves).last(wanted);
  const Half &oldest = window.front(), &newest = window.back();
  const auto later = std::count_if(window.begin(), window.end(),
                                   [&](const Half& half) { return half.frame_end > oldest.frame_end; });
  if (later == 0) return to_s(newest.end - oldest.begin) / static_cast<double>(wanted);
  return to_s(newest.frame_end - oldest.frame_end) / static_cast<double>(later);
}

double CameraRate::Parts::sigma_dps(const SpeedPosterior& found, double speed_dps) const {
  const double misfit = std::max(1.0, found.noise_variance / noise_variance);
  const double sigma =
      std::hypot(found.sigma * speed_dps * misfit, rate_share * found.speed * speed_dps, least_sigma_dps);
  return found.is_at_end ? std::max(sigma, any_rate_sigma_dps) : sigma;
}

/// By the window's images, and by what a window before has told that shares none of them. That chooses among
/// the rates that fit, and makes none surer: the camera may just have begun to turn in another way.
SpeedPosterior CameraRate::Parts::posterior(const Half& oldest, double step, double speed_dps) {
  const SpeedPosterior alone = search.search(lines, noise_variance, fastest_dps / speed_dps);
  const HostTime end = halves.back().end;
  const HostTime begin = oldest.begin + from_s(0.5 * step);  // times of halves wander a little
  const std::optional<EarlierRate> expected = earlier.expected(begin, end);
  const double alone_sigma_dps = sigma_dps(alone, speed_dps);
  if (alone_sigma_dps < told_sigma_dps) earlier.add({end, alone.speed * speed_dps, alone_sigma_dps});
  if (!expected) return alone;
  SpeedPosterior both =
      search.expecting({.speed = expected->rate_dps / speed_dps, .width = expected->sigma_dps / speed_dps});
  both.sigma = std::max(both.sigma, alone.sigma);
  return both;
}

void CameraRate::Parts::look(std::size_t wanted, CameraRateReport& report) {
  std::array<const HalfLines*, most_halves> newest;
  for (std::size_t i = 0; i < wanted; ++i) newest[i] = &halves[most_halves - wanted + i].lines;
  const Half& oldest = halves[most_halves - wanted];
  const double step = step_s(wanted), speed_dps = pitch_deg / step;
  report.window_s = step * static_cast<double>(wanted);
  lines.set(oldest.parity, std::span(newest).first(wanted));
  const SpeedPosterior found = posterior(oldest, step, speed_dps);
  report.rate_dps = direction * found.speed * speed_dps;
  report.misfit = found.noise_variance / noise_variance;
  report.sigma_dps = sigma_dps(found, speed_dps);
  report.is_told = report.sigma_dps < told_sigma_dps;
  noise_variance =
      std::max(least_noise_variance,
               noise_variance * (1.0 + noise_share * (std::min(report.misfit, most_misfit) - 1.0)));
  report.noise_c = std::sqrt(noise_variance);
  if (!report.is_told || std::abs(report.rate_dps) < moving_dps) return;
  errors.learn(halves.back().parity);
}

CameraRate::CameraRate(const CameraProfile& camera, int frames)
    : parts_(std::make_unique<Parts>(camera, frames)) {}
CameraRate::~CameraRate() = default;
CameraRate::CameraRate(CameraRate&&) noexcept = default;
CameraRate& CameraRate::operator=(CameraRate&&) noexcept = default;

CameraRateReport CameraRate::add(const TimedFrame& frame) {
  Parts& parts = *parts_;
  CameraRateReport report;
  const bool is_timed = !frame.late && !frame.stale && !frame.stands_in;
  std::size_t taken = 0;
  for (const unsigned parity : frame.halves_by_time())
    if (is_timed && frame.is_fresh(parity) && frame.half[parity].is_possible() && parts.take(frame, parity))
      ++taken;
  report.has_image = taken > 0;
  if (taken == 0) parts.count = 0;
  parts.in_a_row = taken > 0 ? std::min(parts.in_a_row + 1, most_window_frames) : 0;
  std::rotate(parts.fresh.begin(), parts.fresh.begin() + 1, parts.fresh.end());
  parts.fresh.back() = taken;
  const std::size_t wanted = parts.halves_of_window();
  report.is_complete = parts.in_a_row >= parts.frames && parts.count >= wanted;
  if (report.is_complete) parts.look(wanted, report);
  return report;
}

}  // namespace thermorig::likelihood
