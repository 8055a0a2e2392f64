// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace thermorig::app {

// Figures of `evaluate` for people; "unknown" for NaN.
std::string mse_text(double mse);        // 0.00512
std::string rate_text(double rate_dps);  // 14.30
std::string gain_text(double gain);      // 0.553
std::string percent_text(double share);  // 3.2 %
std::string angle_text(double deg);      // -12.4, of deg and deg/min

/// What a gate does that has collapsed, by the mean of its Kg.
std::string collapsed_text(double gain_mean);

}  // namespace thermorig::app
