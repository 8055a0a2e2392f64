// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>

#include "thermorig/core/reading.h"
#include "thermorig/core/time.h"

namespace thermorig {

/// How long a gyro has sent the very same numbers about all axes: noise never repeats itself for long, but a
/// gyro that hangs does, and one that sets itself to zero at rest.
class RepeatedReading {
 public:
  /// False: it is another than the one before.
  bool add(const GyroReading& reading, HostTime time);
  /// Repeats count from here on.
  void restart(HostTime time) { since_ = time, repeats_ = 0; }

  std::size_t repeats() const { return repeats_; }
  bool lasts(HostDuration span) const { return last_ && time_ - since_ >= span; }
  bool is_zero() const { return last_ && last_->is_zero(); }
  const std::optional<GyroReading>& last() const { return last_; }

 private:
  std::optional<GyroReading> last_;
  HostTime since_{}, time_{};
  std::size_t repeats_ = 0;
};

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
