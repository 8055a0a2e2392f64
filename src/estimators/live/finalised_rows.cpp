// SPDX-License-Identifier: MIT
#include "thermorig/estimators/live/finalised_rows.h"

#include <algorithm>
#include <cmath>

#include "thermorig/core/estimate.h"
#include "thermorig/network/window_index.h"

namespace thermorig::live {

namespace {

constexpr auto unknown_dps = static_cast<float>(unknown);

/// Does the finished session know the row's frame? The clock of a running recorder is off by much less than
/// half a period, and a stand-in for a frame that never came by seconds.
bool is_known(const EstimateRow& row, const network::Acquisition& finished, double frame_period_s) {
  if (row.frame_index >= finished.frames()) return false;
  return std::abs(seconds_between(finished.time[row.frame_index], row.time)) <= frame_period_s / 2.0;
}

/// Unknown for a frame that has too few before it.
float label_at(const network::Acquisition& finished, std::uint32_t frame, int frames) {
  if (std::size_t{frame} + 1 < static_cast<std::size_t>(frames)) return unknown_dps;
  return network::mean_rate(finished.label_dps, {0, frame}, frames);
}

/// Is the frame the last one of a window?
std::vector<bool> window_ends(const network::Acquisition& finished, int frames) {
  std::vector<bool> ends(finished.frames());
  for (const network::Window& window : network::find_windows({&finished, 1}, frames))
    ends[window.last] = true;
  return ends;
}

}  // namespace

FinalisedRows finalised_rows(std::span<const EstimateRow> rows, const network::Acquisition& finished,
                             int frames, double frame_period_s) {
  const std::vector<bool> ends = window_ends(finished, frames);
  FinalisedRows finalised;
  finalised.windows = static_cast<std::uint64_t>(std::count(ends.begin(), ends.end(), true));
  double sum_dps = 0.0, largest_dps = 0.0;
  for (const EstimateRow& row : rows) {
    EstimateRow& better = finalised.rows.emplace_back(row);
    better.rate_commanded_dps =
        is_known(row, finished, frame_period_s) ? label_at(finished, row.frame_index, frames) : unknown_dps;
    const double difference_dps =
        static_cast<double>(better.rate_commanded_dps) - static_cast<double>(row.rate_commanded_dps);
    better.counted = row.counted && std::isfinite(difference_dps);
    if (!better.counted) continue;
    ++finalised.compared;
    finalised.counted_in_both += ends[row.frame_index] ? 1 : 0;
    sum_dps += difference_dps;
    largest_dps = std::max(largest_dps, std::abs(difference_dps));
  }
  const bool any = finalised.compared > 0;
  finalised.label_difference_mean_dps =
      any ? sum_dps / static_cast<double>(finalised.compared) : double{unknown};
  finalised.label_difference_max_dps = any ? largest_dps : double{unknown};
  return finalised;
}

}  // namespace thermorig::live
