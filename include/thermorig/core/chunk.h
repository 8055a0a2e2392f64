// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "thermorig/core/device.h"
#include "thermorig/core/time.h"

namespace thermorig {

/// Bytes as one read() returned them, and when it returned.
struct Chunk {
  Device device = Device::camera;
  HostTime arrived{};
  std::vector<std::uint8_t> bytes;
};

/// Where a message stands in its device's byte stream: offsets from the first byte ever read.
struct StreamSpan {
  std::uint64_t begin = 0;  // offset of the first byte
  std::uint64_t end = 0;    // offset one past the last byte
  std::uint64_t size() const { return end - begin; }
  bool operator==(const StreamSpan&) const = default;
};

}  // namespace thermorig
