// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace thermorig::model {

/// How much memory operator new has handed out since this was made and not got back, at the most. Only one at
/// a time, in one thread.
class AllocationCount {
 public:
  AllocationCount();
  ~AllocationCount();
  AllocationCount(const AllocationCount&) = delete;
  AllocationCount& operator=(const AllocationCount&) = delete;
  std::size_t peak_bytes() const;
};

}  // namespace thermorig::model
