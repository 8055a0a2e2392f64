// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>

namespace thermorig {

/// Time that `bytes` bytes take on the wire at 8N1; 0 where the link has no baud rate (USB-CDC).
double wire_time_s(std::uint64_t bytes, std::uint32_t baud);

/// A sender's true baud rate is the nominal one, but for so much either way: 2.1 % by a divider that does not
/// fit (ATmega328P data sheet, UBRR table, 115200 baud at 16 MHz), 0.5 % by a ceramic resonator. A receiver
/// bears 4.5 % between the two at most.
inline constexpr double baud_tolerance = 0.026;

/// The least time that `bytes` bytes can take on the wire.
double shortest_wire_time_s(std::uint64_t bytes, std::uint32_t baud);

/// The link budget of a device that sends `bytes_per_message` bytes `rate_hz` times a second.
struct LinkBudget {
  double load = 0.0;         // share of the link's capacity, 1.0 = full
  double max_rate_hz = 0.0;  // messages a second that fit; infinite where the link has no baud rate
  bool fits() const { return load <= 1.0; }
};
LinkBudget link_budget(std::uint64_t bytes_per_message, double rate_hz, std::uint32_t baud);

/// The slowest of the usual baud rates, up to 2 Mbaud, whose link carries so much; none: no such one does.
std::optional<std::uint32_t> usual_baud_for(std::uint64_t bytes_per_message, double rate_hz);

}  // namespace thermorig
