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
/// System calls of a thread that has made such an array may return EINTR, even where SA_RESTART was asked
/// for.
void arrays_near(const std::filesystem::path& near, const Limits& limits = {});

/// Gives pages of such arrays back to the system, if more of them are in memory than shall be. A thread that
/// has made such an array is interrupted four times a millisecond to do so; other threads call this now and
/// then when they look at much of one.
void give_pages_back();

/// Tells when so many bytes have passed by, again and again.
class EveryBytes {
 public:
  explicit EveryBytes(std::size_t bytes) : every_(bytes) {}

  bool is_due_after(std::size_t bytes) {
    if ((passed_ += bytes) < every_) return false;
    passed_ = 0;
    return true;
  }

 private:
  std::size_t every_;
  std::size_t passed_ = 0;
};

/// Bytes of arrays that lie on a disk now.
std::size_t spilled_bytes();

}  // namespace thermorig::spill
