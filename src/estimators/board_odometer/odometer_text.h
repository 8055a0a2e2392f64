// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>
#include <vector>

namespace thermorig::board_odometer {

/// The files of c99/, as the build read them.
extern const std::string_view odometer_h, odometer_c;

/// A header that odometer_c includes, itself or by way of another.
struct OdometerPart {
  std::string_view name;  // without .h
  std::string_view text;
};
const std::vector<OdometerPart>& odometer_parts();

}  // namespace thermorig::board_odometer
