// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "thermorig/sensors/wire/reassembly.h"

namespace thermorig::sensors {

/// The frames of a protocol, each with a mark, a length and a check sum: what it takes to see that they are
/// there, although no sum is right.
struct FramedProtocol {
  std::string_view name;  // "HiPNUC packets"
  /// Of the frame that `rest` (not empty) begins with, in bytes; 0: more are needed; none: no frame begins.
  std::optional<std::size_t> (*size)(wire::Bytes rest);
  bool (*is_good)(wire::Bytes frame);  // its check sum is right
};

/// As a FramedScanner (framed_scanner.h) is given it.
template <typename Framing>
FramedProtocol framed_protocol(std::string_view name) {
  return {name,
          [](wire::Bytes rest) {
            return rest[0] == Framing::sync ? Framing::size(rest) : std::optional<std::size_t>();
          },
          Framing::is_good};
}

FramedProtocol witmotion_frames();
FramedProtocol xsens_frames();
FramedProtocol mip_frames();
FramedProtocol hipnuc_frames();
FramedProtocol mavlink_frames();

}  // namespace thermorig::sensors
