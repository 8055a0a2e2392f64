// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "thermorig/core/estimate_row.h"

namespace thermorig::live {

inline bool same_bits(float a, float b) {
  return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

inline bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

inline bool same_estimate(const RateEstimate& a, const RateEstimate& b) {
  bool same = same_bits(a.rate_dps, b.rate_dps) && same_bits(a.rate_sigma_dps, b.rate_sigma_dps) &&
              same_bits(a.angle_deg, b.angle_deg) && same_bits(a.angle_sigma_deg, b.angle_sigma_deg) &&
              a.state == b.state && a.reason == b.reason;
  for (std::size_t i = 0; i < a.values.size(); ++i) same = same && same_bits(a.values[i], b.values[i]);
  return same;
}

/// Every field, bit for bit: an unknown number equals the same unknown number.
inline bool same_row(const EstimateRow& a, const EstimateRow& b) {
  bool same = a.frame_index == b.frame_index && a.time == b.time && a.exposure_begin == b.exposure_begin &&
              a.exposure_end == b.exposure_end && a.arrival == b.arrival &&
              same_bits(a.rate_commanded_dps, b.rate_commanded_dps) && a.reason_bits == b.reason_bits &&
              a.run == b.run && a.leg == b.leg && a.counted == b.counted;
  for (std::size_t i = 0; i < a.estimates.size(); ++i)
    same = same && same_estimate(a.estimates[i], b.estimates[i]);
  return same;
}

inline bool same_rows(const std::vector<EstimateRow>& a, const std::vector<EstimateRow>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!same_row(a[i], b[i])) return false;
  return true;
}

}  // namespace thermorig::live
