// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "thermorig/core/error.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/rig/recording.h"
#include "thermorig/wire/counters.h"

namespace thermorig::rig {

/// Of a port's bytes so many are kept at first: enough to tell which device it is.
inline constexpr std::size_t first_bytes_kept = 8192;

/// What is known before the first byte, but for the acquisition's number.
RecordingHeader make_header(const RecordingOptions& options, HostTime now);

/// "camera (/dev/ttyUSB0)", or the device alone if it has no port.
std::string place_of(Device device, const RigProfile& profile);

/// Why nothing usable came from a device, from what did come.
Error silent_device(Device device, const RigProfile& profile, const wire::Counters& counters,
                    std::span<const std::uint8_t> first_bytes);

/// Bytes without a good message among them, and for how long they came.
struct Unreadable {
  std::uint64_t bytes = 0;
  double span_s = 0.0;
};

/// A device that could be read before cannot be any more.
Error unreadable_device(Device device, const RigProfile& profile, const Unreadable& unreadable,
                        std::span<const std::uint8_t> first_bytes);

}  // namespace thermorig::rig
