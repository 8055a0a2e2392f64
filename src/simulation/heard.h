// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace thermorig::simulation {

/// What a simulated camera or gyro makes of bytes from the host.
struct Heard {
  bool asks_for_stream = false;
  unsigned asked = 0;                // messages, one by one, and no stream any more
  std::optional<double> rate_hz;     // that it is to send
  std::vector<std::uint8_t> answer;  // sent at once; may be empty
};

}  // namespace thermorig::simulation
