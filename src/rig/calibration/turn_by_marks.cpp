// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "rest.h"
#include "thermorig/core/error.h"
#include "thermorig/core/gyro_blocks.h"
#include "thermorig/rig/calibration/calibration.h"

namespace thermorig::calibration {

namespace {

constexpr double mark_uncertainty_deg = 0.5;      // by eye, against a line: of each of the two
constexpr double slowest_turn_dps = 2.0;          // slower is rest: bias and noise are below
constexpr auto margin = std::chrono::seconds(2);  // hands begin and end slowly, below the limit
constexpr double longest_step_s = 0.05;           // from one sample to the next; more is a gap
constexpr double largest_scale_error = 0.25;

[[noreturn]] void refuse_scale(const std::string& what, const std::string& advice) {
  throw Error(ExitCode::finished_lossy, what, "calibrate scale", advice);
}

struct Turn {
  double angle_deg = 0.0;
  double duration_s = 0.0;
};

/// From the first motion to the last one in a rest of the servo, with a margin; none if nothing moved.
std::optional<Rest> moving_part(std::span<const TimedGyro> gyro, const Rest& rest,
                                const RestingGyro& resting) {
  const double moving_dps = std::max(slowest_turn_dps, 8.0 * resting.noise_dps);
  Rest moving{rest.end, rest.begin};
  for (const TimedGyro& sample : between(gyro, rest.begin, rest.end)) {
    if (std::abs(sample.rate_dps - resting.bias_dps) < moving_dps) continue;
    moving.begin = std::min(moving.begin, sample.stamp.time);
    moving.end = std::max(moving.end, sample.stamp.time);
  }
  if (moving.end < moving.begin) return std::nullopt;
  return Rest{std::max(rest.begin, moving.begin - margin), std::min(rest.end, moving.end + margin)};
}

/// The gyro's rate without its bias, summed up over a rest of the servo, or a part of it.
Turn integrate(std::span<const TimedGyro> gyro, const Rest& rest, double bias_dps) {
  Turn turn;
  const TimedGyro* before = nullptr;
  for (const TimedGyro& sample : between(gyro, rest.begin, rest.end)) {
    if (sample.reading.saturated)
      refuse_scale("the gyro was turned faster than it can measure",
                   "turn the rig more slowly: 10 s or more");
    if (before != nullptr) {
      const double step_s = to_s(sample.stamp.time - before->stamp.time);
      if (step_s > longest_step_s)
        refuse_scale(
            fmt::format("samples of the gyro are missing for {:.0f} ms within the turn", 1e3 * step_s),
            "the same again; `thermorig inspect --timing` says which link loses data");
      turn.angle_deg += step_s * (0.5 * (sample.rate_dps + before->rate_dps) - bias_dps);
    }
    before = &sample;
  }
  turn.duration_s = std::max(0.0, to_s(rest.end - rest.begin));
  return turn;
}

/// The longest motion while the servo stood still.
std::optional<Turn> longest_turn(const session::Session& session, const RestingGyro& resting) {
  std::optional<Turn> longest;
  for (const Rest& rest : rests_of(session.servo, session.gyro)) {
    const auto moving = moving_part(session.gyro, rest, resting);
    if (!moving) continue;
    const Turn turn = integrate(session.gyro, *moving, resting.bias_dps);
    if (!longest || std::abs(turn.angle_deg) > std::abs(longest->angle_deg)) longest = turn;
  }
  return longest;
}

}  // namespace

ScaleResult measure_scale_by_marks(const session::Session& session, double angle_deg) {
  const auto resting = resting_gyro(session.servo, session.gyro);
  if (!resting || session.sync.gyro.zeroes_itself)
    refuse_scale("the rests around the turn do not show the gyro's bias",
                 "leave the rig alone for 10 s before and after the turn");
  const auto turn = longest_turn(session, *resting);
  if (!turn) refuse_scale("the rig was not turned", "turn the whole rig by hand from one mark to the other");
  const double scale = std::abs(turn->angle_deg / angle_deg);
  if (!(std::abs(scale - 1.0) < largest_scale_error))
    refuse_scale(fmt::format("the gyro saw a turn of {:.1f} degrees, not of {:.1f}",
                             std::abs(turn->angle_deg), std::abs(angle_deg)),
                 "one turn between the marks, in one direction, without turning back");
  const double marks = std::sqrt(2.0) * mark_uncertainty_deg / std::abs(angle_deg);
  const double drift = resting->spread_dps * turn->duration_s / std::abs(angle_deg);
  return {.gyro_scale = {scale, std::hypot(marks, drift)}, .turned_deg = std::abs(turn->angle_deg) / scale};
}

}  // namespace thermorig::calibration
