// SPDX-License-Identifier: MIT
#include "thermorig/core/wire_time.h"

#include <limits>

namespace thermorig {

namespace {
constexpr double bits_per_byte = 10.0;  // 8N1: start, 8 data, stop
}  // namespace

double wire_time_s(std::uint64_t bytes, std::uint32_t baud) {
  return baud == 0 ? 0.0 : bits_per_byte * static_cast<double>(bytes) / static_cast<double>(baud);
}

double shortest_wire_time_s(std::uint64_t bytes, std::uint32_t baud) {
  return wire_time_s(bytes, baud) / (1.0 + baud_tolerance);
}

LinkBudget link_budget(std::uint64_t bytes_per_message, double rate_hz, std::uint32_t baud) {
  const double message_s = wire_time_s(bytes_per_message, baud);
  if (message_s <= 0.0) return {.load = 0.0, .max_rate_hz = std::numeric_limits<double>::infinity()};
  return {.load = rate_hz * message_s, .max_rate_hz = 1.0 / message_s};
}

std::optional<std::uint32_t> usual_baud_for(std::uint64_t bytes_per_message, double rate_hz) {
  for (const std::uint32_t baud : {9600U, 57600U, 115200U, 230400U, 460800U, 921600U, 1000000U, 2000000U})
    if (link_budget(bytes_per_message, rate_hz, baud).fits()) return baud;
  return std::nullopt;
}

}  // namespace thermorig
