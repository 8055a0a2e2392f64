// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace thermorig::wire::grbl {

// What is sent to GRBL 1.1, whose first axis turns: its millimetres are degrees. Source: protocols/grbl.md.

inline constexpr std::size_t longest_line = 160;     // of its answers and of ours
inline constexpr double feed_unit_dps = 1.0 / 60.0;  // it reports whole degrees a minute
inline constexpr double position_unit_deg = 0.001;   // and thousandths of a degree

/// A relative jog: it comes to rest by itself at its end, unless the next one is there by then.
struct Jog {
  double way_deg = 0.0;
  double rate_dps = 0.0;  // not negative
  std::uint16_t leg = 0;  // a note in brackets, which GRBL passes over
  double direction() const { return std::copysign(1.0, way_deg); }
};

/// "$J=G91X9.000F1800.0(leg 3)" and a line feed.
std::vector<std::uint8_t> jog_line(const Jog& jog);

/// Of such a line without its ending. None: it is none.
std::optional<Jog> parse_jog(std::string_view line);

/// Real-time bytes, which it obeys at once, whatever else it reads: they belong to no line.
inline constexpr std::uint8_t status_request = '?';  // asks for one report
inline constexpr std::uint8_t jog_cancel = 0x85;     // ramps down, and forgets the jogs that wait
inline constexpr std::uint8_t soft_reset = 0x18;
constexpr bool is_real_time(std::uint8_t byte) {
  return byte == status_request || byte == jog_cancel || byte == soft_reset;
}

/// A line that is all note: whether the sweep holds the shaft from here on. GRBL itself has no such state.
std::vector<std::uint8_t> power_note(bool is_armed);
/// Of such a line without its ending. None: it is none.
std::optional<bool> parse_power_note(std::string_view line);

std::vector<std::uint8_t> settings_request();

/// "$110=12000.000", of which it lists many.
struct Setting {
  int number = 0;
  double value = 0.0;  // finite
};
inline constexpr int steps_setting = 100;         // a degree
inline constexpr int rate_setting = 110;          // degrees a minute, at most
inline constexpr int acceleration_setting = 120;  // degrees a second squared

/// Of such a line without its ending. None: it is none.
std::optional<Setting> parse_setting(std::string_view line);

std::vector<std::uint8_t> unlock();

}  // namespace thermorig::wire::grbl
