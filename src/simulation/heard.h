// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

namespace thermorig::simulation {

/// What a simulated camera or gyro makes of bytes from the host.
struct Heard {
  bool asks_for_stream = false;
  std::vector<std::uint8_t> answer;  // sent at once; may be empty
};

}  // namespace thermorig::simulation
