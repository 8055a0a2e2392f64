// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>

#include "thermorig/sensors/text_format.h"

namespace thermorig::sensors {

/// The turn by hand that tells which column is the rate about the servo's axis, and in which unit.
constexpr double hand_turn_deg = 90.0;

/// What such a turn told of lines that do not say it themselves.
struct HandTurn {
  TextFormat format;  // nothing of it is a guess any more
  int axis = 2;       // of x, y, z: the one that turned
  int column = 0;
};

/// `bytes`, which came in `heard_s` seconds, are of a gyro that lay still, was turned by hand_turn_deg about
/// its vertical axis and lay still again. A rate goes one way and comes back to where it was; an angle or a
/// magnetic field stays elsewhere, an acceleration goes both ways. Its integral is the angle, which tells the
/// unit among the usual ones, a factor of 2 apart. Nothing if no column did so, or if its unit is none of
/// them.
std::optional<HandTurn> turned_by_hand(std::span<const std::uint8_t> bytes, const TextFormat& format,
                                       double heard_s);

/// A unit in which gyros send rates.
struct GyroUnit {
  double scale_dps;  // degrees per second of one
  const char* name;  // "rad/s"
};

/// The usual unit that is near to a measured one: within a third. Nothing: it is none of them.
std::optional<GyroUnit> usual_gyro_unit(double scale_dps);

}  // namespace thermorig::sensors
