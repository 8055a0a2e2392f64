// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string>

namespace thermorig::sensors {

// What names such as "gx_dps", "gyro.x", "t_ms" say about a column.

/// Whether a name means the rate about an axis (0, 1, 2: x, y, z).
bool names_rate(const std::string& name, std::size_t axis);

/// Degrees per second of one unit; none where the name has no unit.
std::optional<double> named_scale_dps(const std::string& name);

bool names_time(const std::string& name);

/// Seconds of one unit; none where the name has no unit.
std::optional<double> named_time_unit_s(const std::string& name);

}  // namespace thermorig::sensors
