// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "thermorig/core/live_estimate.h"

namespace thermorig::live {

inline bool same_bits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

/// Every field, bit for bit: an unknown number equals the same unknown number.
inline bool same_row(const LiveEstimate& a, const LiveEstimate& b) {
  return a.frame_index == b.frame_index && a.time == b.time && a.exposure_begin == b.exposure_begin &&
         a.exposure_end == b.exposure_end && a.arrival == b.arrival &&
         same_bits(a.rate_commanded_dps, b.rate_commanded_dps) &&
         same_bits(a.rate_gyro_dps, b.rate_gyro_dps) && same_bits(a.rate_thermal_dps, b.rate_thermal_dps) &&
         same_bits(a.rate_fusion_dps, b.rate_fusion_dps) && same_bits(a.gain, b.gain) &&
         a.reason_bits == b.reason_bits && a.run == b.run && a.leg == b.leg && a.counted == b.counted;
}

inline bool same_rows(const std::vector<LiveEstimate>& a, const std::vector<LiveEstimate>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!same_row(a[i], b[i])) return false;
  return true;
}

}  // namespace thermorig::live
