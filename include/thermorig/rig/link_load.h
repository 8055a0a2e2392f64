// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "thermorig/core/device.h"
#include "thermorig/core/profile.h"

namespace thermorig::rig {

/// What a device sends all the time.
struct LinkLoad {
  std::uint64_t message_bytes = 0;  // of one frame, sample or telemetry message, at most
  double rate_hz = 0.0;             // messages a second, nominal
  double bytes_per_s() const { return static_cast<double>(message_bytes) * rate_hz; }
};

LinkLoad link_load(Device device, const RigProfile& profile);

}  // namespace thermorig::rig
