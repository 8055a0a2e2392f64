// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thermorig/core/estimate_row.h"
#include "thermorig/core/time.h"
#include "thermorig/network/acquisition.h"

namespace thermorig::live {

/// Any two times may stand in a file: their difference is taken where it cannot overflow.
inline double seconds_between(HostTime begin, HostTime end) {
  return (static_cast<double>(to_ns(end)) - static_cast<double>(to_ns(begin))) * 1e-9;
}

/// The rows of a live run with what the finished session knows better.
struct FinalisedRows {
  /// The label is the finalised one; counted where the live run counted and it is known.
  std::vector<EstimateRow> rows;
  std::uint64_t compared = 0;            // counted rows
  std::uint64_t windows = 0;             // of the finished session: what `evaluate` counts
  std::uint64_t counted_in_both = 0;     // of these the live run counted so many
  double label_difference_mean_dps = 0;  // finalised minus live label over the compared rows; NaN without
  double label_difference_max_dps = 0;   // largest magnitude; NaN without
};

/// Rows and frames are joined by the frame's index where their times are at most half a frame period apart:
/// a row that stands in for a frame of a camera that was not there may have the index of one that came when
/// it was back. `frames`: Nf, 1 without a network. `frame_period_s`: of the finished session.
FinalisedRows finalised_rows(std::span<const EstimateRow> rows, const network::Acquisition& finished,
                             int frames, double frame_period_s);

}  // namespace thermorig::live
