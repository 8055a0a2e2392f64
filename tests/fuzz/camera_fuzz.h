// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <vector>

#include "scanner_fuzz.h"
#include "thermorig/sensors/camera_protocol.h"

namespace thermorig::test {

/// A camera's scanner that has read the input, and the images that came of it: 768 finite temperatures each.
struct FuzzedCamera {
  FuzzedCamera(const char* protocol, ByteSpan input, std::size_t pending_max)
      : scanner(sensors::camera_scanner(profile_of(protocol))) {
    fuzz_scanner<wire::CameraMessage>(sensors::camera_scanner(profile_of(protocol)), input, pending_max);
    scanner.push(input, messages);
    for (const auto& message : messages)
      for (const float temp_c : message.frame.temp_c)
        require(std::isfinite(temp_c), "temperatures are finite");
  }

  static CameraProfile profile_of(const char* protocol) {
    CameraProfile profile;
    profile.protocol = protocol;
    return profile;
  }

  sensors::CameraScanner scanner;
  std::vector<wire::CameraMessage> messages;
};

}  // namespace thermorig::test
