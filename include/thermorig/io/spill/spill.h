// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>

namespace thermorig::spill {

struct Limits {
  std::size_t array_bytes = 1U << 20U;       // a block of so many is a large array
  std::size_t in_memory_bytes = 16U << 20U;  // of large arrays together, before others go to the disk
};

/// From here on, for the rest of the program, large arrays (whatever asks `new` for so much) lie in files
/// without a name on the disk of `near`, once there are more of them than memory shall hold. To the program
/// they are memory; their pages are the system's, which writes them to the disk and takes them back when
/// memory runs short. Called again, it changes where new arrays go. Where no disk has room they stay in
/// memory. May be called from several threads.
void arrays_near(const std::filesystem::path& near, const Limits& limits = {});

/// From here on large arrays lie in memory. For a process that was forked off, which ends without freeing
/// what it was born with: what lies in files it would share with the process that it comes from, and a lock
/// of this may be held for ever.
void arrays_in_memory();

/// Bytes of arrays that lie on a disk now.
std::size_t spilled_bytes();

}  // namespace thermorig::spill
