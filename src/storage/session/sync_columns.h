// SPDX-License-Identifier: MIT
#pragma once

#include "device_columns.h"
#include "thermorig/core/sync.h"

namespace thermorig::session {

// The tables of /sync. Archive is GroupWriter or GroupReader.

/// Of one device: knots of its fitted clock, epochs and gaps.
template <typename Archive, typename Clock>
void clock_columns(Archive& archive, Clock& clock) {
  archive.time_axis({"knot_time", "s", "time since time_reference of each knot of the fitted clock [s]"},
                    clock.knots, &ClockKnot::time);
  archive.template field<double>({"offset", "s", "host time minus the device's time at the knot [s]"},
                                 clock.knots, &ClockKnot::offset_s);
  archive.template field<double>(
      {"skew_ppm", "1e-6", "how much faster than the device's time host time runs at the knot [ppm]"},
      clock.knots, &ClockKnot::skew_ppm);
  archive.template field<double>(
      {"residual_us", "us", "what the clock leaves unexplained at the knot [us]",
       "one-way: median lateness of the chunks around; two-way: half the width of the bounds"},
      clock.knots, &ClockKnot::residual_us);
  archive.time_axis(
      {"epoch_begin", "s", "time since time_reference at which an epoch of the clock begins [s]"},
      clock.epochs, &ClockEpoch::begin);
  archive.texts({"epoch_reason", "1", "why the epoch before ended"}, clock.epochs, &ClockEpoch::reason);
  archive.time_axis(
      {"gap_begin", "s", "time since time_reference of the last message before messages were lost [s]"},
      clock.gaps, &ClockGap::begin);
  archive.time_column({"gap_end", "s", "time of the first message after it [s]"}, clock.gaps, &ClockGap::end);
  archive.template field<std::uint64_t>({"gap_missing", "1", "messages that were lost"}, clock.gaps,
                                        &ClockGap::missing);
}

/// By what the servo's slope repeats over the shaft's angle.
template <typename Archive, typename Ripples>
void ripple_columns(Archive& archive, Ripples& ripples) {
  using Ripple = ServoResponse::Ripple;
  archive.template axis<double>({"ripple_period", "deg", "angle over which the servo's slope repeats [deg]"},
                                ripples, &Ripple::period_deg);
  const auto share = [&](const char* name, const char* what, double Ripple::*member) {
    archive.template field<double>({name, "1", what}, ripples, member);
  };
  share("ripple_forward_cosine", "share of the slope, angle growing: cosine", &Ripple::forward_cosine);
  share("ripple_forward_sine", "share of the slope, angle growing: sine", &Ripple::forward_sine);
  share("ripple_backward_cosine", "share of the slope, the other way: cosine", &Ripple::backward_cosine);
  share("ripple_backward_sine", "share of the slope, the other way: sine", &Ripple::backward_sine);
}

/// Of the servo model: its gain over the pulse widths, and what it leaves of the gyro, by commanded speed.
template <typename Archive, typename Response>
void response_columns(Archive& archive, Response& response) {
  archive.bare_axis("knot", "knot, evenly spaced from the shortest pulse to the longest", response.gain,
                    "gain");
  archive.template field<double>(
      {"gain", "1", "servo model: slope over its mean at each knot", "straight between knots; empty: 1"},
      response.gain, [](auto& value) -> auto& { return value; });
  auto& speeds = response.speeds;
  archive.template axis<double>({"speed", "deg/s", "commanded speed [deg/s]"}, speeds,
                                &ServoResponse::AtSpeed::rate_dps);
  archive.template field<double>(
      {"speed_residual", "deg/s", "corrected gyro minus servo model: mean [deg/s]"}, speeds,
      &ServoResponse::AtSpeed::residual_dps);
  archive.template field<double>(
      {"speed_spread", "deg/s", "corrected gyro minus servo model: root mean square about the mean [deg/s]"},
      speeds, &ServoResponse::AtSpeed::spread_dps);
  archive.template field<std::uint32_t>({"speed_frames", "1", "frame periods that took part"}, speeds,
                                        &ServoResponse::AtSpeed::frames);
  if (archive.version() < with_checked_constants) return;
  archive.template field<double>({"speed_reached", "deg/s", "corrected gyro: mean [deg/s]"}, speeds,
                                 &ServoResponse::AtSpeed::reached_dps);
  archive.template column<std::uint8_t>(
      {"speed_contradicts", "1", "1: the shaft does not turn as commanded, beyond what is uncertain"}, speeds,
      [](const auto& speed) { return static_cast<std::uint8_t>(speed.contradicts ? 1 : 0); },
      [](auto& speed, std::uint8_t value) { speed.contradicts = value != 0; });
  if (archive.version() < with_corrected_label) return;
  archive.template field<double>(
      {"speed_noise", "deg/s", "noise of a gyro sample while the shaft turns [deg/s]"}, speeds,
      &ServoResponse::AtSpeed::noise_dps);
  ripple_columns(archive, response.ripples);
}

/// How the gyro's bias went.
template <typename Archive, typename Course>
void bias_columns(Archive& archive, Course& course) {
  archive.time_axis({"bias_time", "s", "time since time_reference of each knot of the gyro's bias [s]"},
                    course, &BiasKnot::time);
  archive.template field<double>(
      {"bias", "deg/s", "the gyro's bias at the knot [deg/s]", "straight between knots; empty: it stayed"},
      course, &BiasKnot::bias_dps);
}

}  // namespace thermorig::session
