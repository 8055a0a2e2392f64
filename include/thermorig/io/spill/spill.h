// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>

namespace thermorig::spill {

struct Limits {
  std::size_t array_bytes = 1U << 20U;       // a block of so many is a large array
  std::size_t in_memory_bytes = 16U << 20U;  // of large arrays together, before others go to the disk
  std::size_t resident_bytes = 36U << 20U;   // of mapped pages of files, the program's own included
};

/// From here on, for the rest of the program, large arrays (whatever asks `new` for so much) lie in files
/// without a name on the disk of `near`, once there are more of them than memory shall hold. To the program
/// they are memory; what it has not touched lately is on the disk alone. Called again, it changes where new
/// arrays go. Where no disk has room they stay in memory. May be called from several threads.
void arrays_near(const std::filesystem::path& near, const Limits& limits = {});

/// Gives pages of such arrays back to the system, if more of them are in memory than shall be. A thread does
/// that four times a millisecond; who looks at large arrays quickly calls it now and then.
void give_pages_back();

/// Gives pages back on the way along an array whose rows are large and hardly looked at: such a walk brings
/// hundreds of megabytes into memory before a thread looks.
class Pace {
 public:
  void passed(std::size_t bytes) {
    constexpr std::size_t look_after_bytes = 2U << 20U;
    if ((bytes_ += bytes) < look_after_bytes) return;
    bytes_ = 0;
    give_pages_back();
  }

 private:
  std::size_t bytes_ = 0;
};

/// Bytes of arrays that lie on a disk now.
std::size_t spilled_bytes();

}  // namespace thermorig::spill
