// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

#include <compare>
#include <string>

namespace thermorig::session {

/// Of the session format, without the patch.
struct FormatVersion {
  unsigned major = 0, minor = 0;

  friend auto operator<=>(const FormatVersion&, const FormatVersion&) = default;
  std::string text() const { return fmt::format("{}.{}", major, minor); }
};

inline constexpr const char* format_name = "thermorig-session";
inline constexpr const char* licence_not_stated = "not stated";
inline constexpr FormatVersion format_version{2, 5};  // that is written
inline constexpr unsigned first_format_major = 1;     // that is read, whatever the minor version

// What came with which version.
inline constexpr FormatVersion with_sync_report{1, 1};  // and bounds of times, halves, two labels
inline constexpr FormatVersion with_attribute_sums{1, 3};
inline constexpr FormatVersion with_named_estimators{2, 0};
inline constexpr FormatVersion with_profile_apart{
    2, 0};  // in groups of its own, not in the header; the plan too
inline constexpr FormatVersion with_checked_constants{2, 1};  // and how the gyro's bias went
inline constexpr FormatVersion with_corrected_label{2, 2};    // and ripples of the servo
inline constexpr FormatVersion with_needed_wander{2, 3};      // of a clock
inline constexpr FormatVersion with_witnesses{2, 4};  // and times of no samples, rates that decay, bad pixels
inline constexpr FormatVersion with_measured_shaft{2, 5};

}  // namespace thermorig::session
