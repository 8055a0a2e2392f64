// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "thermorig/sensors/text_format.h"

namespace thermorig::sensors {

/// Why some bytes look like those of one protocol.
struct Evidence {
  std::uint64_t messages = 0;              // frames, samples, telemetry and answers
  std::uint64_t bytes = 0;                 // in good messages of any kind
  std::string text;                        // "12 WitMotion gyro packets"
  std::optional<TextFormat> text_format;   // of lines of text: how they are read
  std::string advice;                      // it cannot be used as it is: what to try; else empty
  std::map<std::string, double> settings;  // what the profile has to say of a gyro that sends these
  bool is_asked_otherwise = false;  // a recording asks it for better ones, so that no profile need say that
};

/// A baud rate that devices of a protocol are usually set to.
struct UsualBaud {
  std::uint32_t baud = 0;
  double share = 0.0;  // of the time of a search: so long one has to listen at it to be sure
};

}  // namespace thermorig::sensors
