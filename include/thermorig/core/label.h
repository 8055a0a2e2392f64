// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace thermorig {

/// Which speed of a frame a network learns: a column of `/samples`, `rate_` before its name.
enum class Label : std::uint8_t {
  commanded,  // what the servo was told: the paper's
  corrected,  // the same, corrected by what the session measured of its servo
  shaft,      // what the shaft did: measured, where something measures it, else by the servo model
  measured,   // what a sensor on the shaft says, and nothing where there is none
};

inline constexpr std::array<std::string_view, 4> label_names{"commanded", "corrected", "shaft", "measured"};

/// "commanded".
std::string_view name_of(Label label);

/// "rate_commanded": its column.
std::string column_of(Label label);

/// None: there is no such label.
std::optional<Label> find_label(std::string_view name);

/// Throws Error(bad_usage) with the names that there are.
Label label_named(std::string_view name);

}  // namespace thermorig
