// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>

namespace thermorig::report {

/// Test MSE over six folds as the paper prints it (section IV, its two tables), measured on real data. The
/// paper does not state the unit.
struct PaperRow {
  int frames, reduction;
  double median_thermal, median_fusion, iqr_thermal, iqr_fusion;
};
inline constexpr std::array<PaperRow, 7> paper_rows{{
    {2, 1, 0.014, 0.008, 0.017, 0.007},
    {3, 1, 0.005, 0.005, 0.004, 0.005},
    {4, 1, 0.009, 0.005, 0.016, 0.014},
    {5, 1, 0.007, 0.008, 0.011, 0.005},
    {6, 1, 0.008, 0.009, 0.018, 0.005},
    {3, 2, 0.013, 0.010, 0.005, 0.003},
    {3, 3, 0.024, 0.015, 0.022, 0.009},
}};

/// The setting that both of the paper's sweeps share.
inline constexpr int paper_frames = 3, paper_reduction = 1;

/// Where the paper's histogram of Kg has its peak (Fig. 3).
inline constexpr double paper_gain_peak = 0.55;

std::optional<PaperRow> paper_row(int frames, int reduction);

}  // namespace thermorig::report
