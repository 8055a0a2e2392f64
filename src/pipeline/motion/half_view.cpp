// SPDX-License-Identifier: MIT
#include "half_view.h"

#include <cmath>

namespace thermorig::motion {
namespace {

HalfExposure exposure_of(const TimedFrame& frame, unsigned parity, NewerHalf newer) {
  if (!newer) return frame.half[parity];
  const HostTime middle = frame.exposure_begin + (frame.exposure_end - frame.exposure_begin) / 2;
  return parity == *newer ? HalfExposure{middle, frame.exposure_end}
                          : HalfExposure{frame.exposure_begin, middle};
}

HalfView view_of(const FreshHalf& half) {
  HalfView view{.half = half, .temp_c = pixels_of(half.frame->frame, half.parity), .trust = {}};
  for (std::size_t i = 0; i < half_pixels; ++i) {
    const bool is_read = !std::isnan(view.temp_c[i]);
    if (!is_read) view.temp_c[i] = 0.0F;
    view.trust[i] = is_read ? 1.0F : 0.0F;
  }
  return view;
}

}  // namespace

std::vector<FreshHalf> fresh_halves(std::span<const TimedFrame> frames, const AngleTrack& track,
                                    double bias_dps, double margin_s, NewerHalf newer) {
  std::vector<FreshHalf> halves;
  for (const TimedFrame& frame : frames) {
    if (frame.late || frame.stale) continue;
    if (newer && !(frame.is_fresh(0) && frame.is_fresh(1))) continue;
    for (const unsigned parity : {0U, 1U}) {
      if (!frame.is_fresh(parity)) continue;
      const HalfExposure exposure = exposure_of(frame, parity, newer);
      if (!exposure.is_possible()) continue;
      const double begin_s = track.seconds(exposure.begin);
      const double end_s = track.seconds(exposure.end);
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
