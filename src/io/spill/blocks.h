// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstddef>
#include <filesystem>
#include <map>
#include <mutex>

#include "thermorig/io/spill/spill.h"

namespace thermorig::spill {

/// Large blocks of memory, some of them mapped from files. What this needs for itself are small blocks. Never
/// destroyed.
class Blocks {
 public:
  void configure(const std::filesystem::path& near, const Limits& limits);

  bool is_large(std::size_t bytes) const { return bytes >= array_bytes_; }

  /// Nothing where the system has no such memory.
  void* allocate(std::size_t bytes);
  /// False for what allocate() did not give.
  bool release(void* at);

  std::size_t on_disk_bytes();

  /// Whether this thread is in one of these functions, whose own blocks are small ones.
  static bool is_inside();

 private:
  struct Block {
    std::size_t bytes = 0;
    bool is_on_disk = false;
  };
  class Inside;

  std::mutex mutex_;
  std::filesystem::path near_;
  Limits limits_;
  std::atomic<std::size_t> array_bytes_ = Limits().array_bytes;  // of limits_, for who has no lock
  std::map<void*, Block> blocks_;
  std::size_t in_memory_bytes_ = 0;
  std::size_t on_disk_bytes_ = 0;
};

/// Those of the program.
Blocks& blocks();

/// Whether large blocks are the business of blocks(): since arrays_near().
inline std::atomic<bool> is_on = false;

}  // namespace thermorig::spill
