// SPDX-License-Identifier: MIT
#include "thermorig/sensors/wire/reassembly.h"

#include <cstring>

namespace thermorig::wire {

std::size_t bytes_before(std::uint8_t sync, Bytes bytes) {
  if (bytes.empty()) return 0;
  const void* found = std::memchr(bytes.data(), sync, bytes.size());
  if (found == nullptr) return bytes.size();
  return static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - bytes.data());
}

}  // namespace thermorig::wire
