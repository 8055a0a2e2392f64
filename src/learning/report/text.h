// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>

#include "thermorig/core/count_text.h"

namespace thermorig::report {

/// Stands where there is no value.
inline constexpr const char* no_value = "-";
/// Stands where a job is missing.
inline constexpr const char* no_result = "no result";

std::string mse_text(double mse);                     // "0.0122", "0.00023"
std::string rate_text(double dps);                    // "22.1", "0.84"
std::string angle_text(double deg);                   // "-12.3", "577"
std::string share_text(double share);                 // "12 %"
std::string setting_text(int frames, int reduction);  // "Nf = 3, Nr = 1"

/// The text with bytes that are no UTF-8 replaced and control characters turned into spaces.
std::string clean(const std::string& text);

}  // namespace thermorig::report
