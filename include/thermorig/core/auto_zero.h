// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "thermorig/core/reading.h"

namespace thermorig {

/// Finds a gyro that sets itself to zero at rest, as WitMotion's do: it reads exactly 0 about all axes for
/// many samples in a row, where the noise of one that measures would move the last bit now and then. Its bias
/// is hidden then. Whose readings come in steps too coarse for any noise is not judged.
class AutoZero {
 public:
  /// So many zeros in a row no gyro with noise shows: a quarter of a second at 200 Hz.
  static constexpr std::size_t fewest_zeros = 50;

  /// The next sample; an axis that is not sent is 0.
  void add(const GyroReading& reading);

  /// Samples are left out here: no run of zeros reaches over it.
  void pause() { zeros_ = 0; }

  bool is_seen() const { return longest_ >= fewest_zeros && !is_coarse(); }

  /// Zeros in the longest run.
  std::size_t longest() const { return longest_; }

 private:
  bool is_coarse() const;

  std::array<float, 3> last_dps_{};
  std::size_t zeros_ = 0;  // in a row, up to the newest sample
  std::size_t longest_ = 0;
  float resolution_dps_ = std::numeric_limits<float>::infinity();  // least step between two samples
};

}  // namespace thermorig
