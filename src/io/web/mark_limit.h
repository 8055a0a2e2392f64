// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>

namespace thermorig::web {

/// How fast the pages together may set marks: some at once, then one a period. Each is an event of the
/// recording and a record of its journal, and a key that is held down or a script would fill the disk.
class MarkLimit {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// At least one at once; a positive period.
  MarkLimit(std::size_t at_once, std::chrono::milliseconds period)
      : period_(period), ahead_(period * (at_once - 1)) {}

  /// Takes one at `now`, which never goes back. False: there were too many, and this one does not count.
  bool take(Time now) {
    const Time due = std::max(due_, now);
    if (due - now > ahead_) return false;
    due_ = due + period_;
    return true;
  }

 private:
  std::chrono::steady_clock::duration period_, ahead_;
  Time due_ = Time::min();  // of the next one, if there were one a period
};

}  // namespace thermorig::web
