// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace thermorig::board_odometer {

/// The files of c99/, as the build read them.
extern const std::string_view odometer_h, odometer_c;

}  // namespace thermorig::board_odometer
