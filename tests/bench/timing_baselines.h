// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

namespace thermorig::bench {

// What others do with the same bytes: each turns the arrivals of numbered messages into their times. The
// messages' numbers are given, which is more than these methods have in the field.

/// A message: its place on its device's clock, and its arrival minus its wire time and its latency.
struct Arrival {
  double device_s = 0.0;
  double host_s = 0.0;
};

/// The arrival itself.
std::vector<double> arrival_times(std::span<const Arrival> arrivals);

/// Least-squares line through all of them, as pyxdf does with each segment (src/pyxdf/pyxdf.py,
/// _jitter_removal).
std::vector<double> least_squares_line(std::span<const Arrival> arrivals);

/// Recursive least squares of offset and rate that forgets half in 90 s, causal, as liblsl does
/// (src/time_postprocessor.cpp, postproc_dejitterer).
std::vector<double> recursive_least_squares(std::span<const Arrival> arrivals);

/// The line of the lower convex hull's segment at the middle of the recording, one point a message, as
/// Kalibr does (sm_timing/TimestampCorrector.hpp).
std::vector<double> convex_hull_line(std::span<const Arrival> arrivals);

/// A ping that was answered, all four times in seconds.
struct RoundTrip {
  double host_sent_s = 0.0;
  double device_received_s = 0.0;
  double device_sent_s = 0.0;
  double host_arrived_s = 0.0;
};

/// Times of `device_s` by the fastest of the last eight round trips, path taken to be symmetric, held until
/// the next eight, as liblsl does (src/time_receiver.cpp).
std::vector<double> fastest_round_trips(std::span<const double> device_s, std::span<const RoundTrip> trips);

/// Times of `device_s` by Klipper's regression of a micro-controller's clock (klippy/clocksync.py): a ping
/// about every second, sent times against its clock with a decay of a thirtieth a ping, plus half of the
/// shortest round trip.
std::vector<double> klipper_regression(std::span<const double> device_s, std::span<const RoundTrip> trips);

}  // namespace thermorig::bench
