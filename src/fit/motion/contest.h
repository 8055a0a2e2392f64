// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "half_view.h"

namespace thermorig::motion {

/// Two panoramas of the same views compete: which one do the views fit better, and is that more than chance?
class Contest {
 public:
  /// Views within a block of time are taken for one witness.
  explicit Contest(double block_s) : block_s_(block_s) {}

  /// Residual variances of each view in either panorama.
  void add(std::span<const FreshHalf> halves, std::span<const double> first, std::span<const double> second);

  bool empty() const { return differences_.empty(); }

  /// How much better the first one fits, in standard deviations of what chance gives: by the mean difference
  /// against its spread among blocks of time, or by the blocks' signed ranks, whichever is clearer. Where a
  /// few blocks tell much (at rest, before a window) and all others little but the same, the spread hides
  /// what all agree upon. Negative: the second one fits better. 0 with too few blocks.
  double lead() const;

 private:
  double block_s_;
  // Of blocks: mean logarithm of second over first. A few strong edges would drown all else in a plain
  // difference.
  std::vector<double> differences_;
};

/// About as long as a rig that sweeps looks into one direction.
inline constexpr double sweeping_block_s = 1.0;

/// A lead that chance does not give, blocks being few and their spread an estimate.
inline constexpr double clear_lead = 4.5;

}  // namespace thermorig::motion
