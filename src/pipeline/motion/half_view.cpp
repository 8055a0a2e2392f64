// SPDX-License-Identifier: MIT
#include "half_view.h"

#include <cmath>

namespace thermorig::motion {
namespace {

constexpr std::uint16_t fresh_pixels = half_pixels / 50;  // 2 %, as the detector of freshness has it
constexpr double longest_exposure_s = 4.0;                // 0.5 Hz, the slowest the bridge knows, and clocks
constexpr float coldest_c = -60.0F;                       // beyond: not a temperature of the sensor's range
constexpr float hottest_c = 400.0F;

HalfExposure exposure_of(const TimedFrame& frame, unsigned parity, NewerHalf newer) {
  if (!newer) return frame.half[parity];
  const HostTime middle = frame.exposure_begin + (frame.exposure_end - frame.exposure_begin) / 2;
  return parity == *newer ? HalfExposure{middle, frame.exposure_end}
                          : HalfExposure{frame.exposure_begin, middle};
}

bool is_fresh(const TimedFrame& frame, unsigned parity) {
  return (parity == 0 ? frame.fresh_even : frame.fresh_odd) > fresh_pixels;
}

HalfView view_of(const FreshHalf& half) {
  HalfView view{.half = half, .temp_c = {}, .trust = {}};
  for (std::size_t column = 0; column < frame_columns; ++column)
    for (std::size_t k = 0; k < half_rows; ++k) {
      const float temp_c = half.frame->frame.temp_c[row_of(column, k, half.parity) * frame_columns + column];
      const bool good = temp_c > coldest_c && temp_c < hottest_c;  // false for NaN
      view.temp_c[column * half_rows + k] = good ? temp_c : 0.0F;
      view.trust[column * half_rows + k] = good ? 1.0F : 0.0F;
    }
  return view;
}

}  // namespace

std::vector<FreshHalf> fresh_halves(std::span<const TimedFrame> frames, const AngleTrack& track,
                                    double bias_dps, double margin_s, NewerHalf newer) {
  std::vector<FreshHalf> halves;
  for (const TimedFrame& frame : frames) {
    if (frame.late || frame.stale) continue;
    if (newer && !(is_fresh(frame, 0) && is_fresh(frame, 1))) continue;
    for (const unsigned parity : {0U, 1U}) {
      if (!is_fresh(frame, parity)) continue;
      const HalfExposure exposure = exposure_of(frame, parity, newer);
      const double begin_s = track.seconds(exposure.begin);
      const double end_s = track.seconds(exposure.end);
      if (end_s <= begin_s || end_s - begin_s > longest_exposure_s) continue;
      const auto stretch = track.stretch(begin_s - margin_s, end_s + margin_s);
      if (!stretch) continue;
      const double rate_dps = track.over(begin_s, end_s).rate_dps - bias_dps;
      const double third_s = (end_s - begin_s) / 3.0;
      const double change_dps =
          track.over(end_s - third_s, end_s).rate_dps - track.over(begin_s, begin_s + third_s).rate_dps;
      halves.push_back({&frame, parity, begin_s, end_s, rate_dps, std::abs(change_dps), *stretch});
    }
  }
  return halves;
}

std::vector<FreshHalf> dealt_anew(std::span<const FreshHalf> halves, const AngleTrack& track,
                                  unsigned newer) {
  std::vector<FreshHalf> dealt(halves.begin(), halves.end());
  for (FreshHalf& half : dealt) {
    const HalfExposure exposure = exposure_of(*half.frame, half.parity, newer);
    half.begin_s = track.seconds(exposure.begin);
    half.end_s = track.seconds(exposure.end);
  }
  return dealt;
}

std::vector<HalfView> views_of(std::span<const FreshHalf> halves) {
  std::vector<HalfView> views;
  views.reserve(halves.size());
  for (const FreshHalf& half : halves) views.push_back(view_of(half));
  return views;
}

}  // namespace thermorig::motion
