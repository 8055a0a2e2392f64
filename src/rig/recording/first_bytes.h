// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thermorig::rig {

/// What a port sent first: enough to tell which device it is.
class FirstBytes {
 public:
  void add(std::span<const std::uint8_t> bytes) {
    const auto some = bytes.first(std::min(most - kept_.size(), bytes.size()));
    kept_.insert(kept_.end(), some.begin(), some.end());
    count_ += bytes.size();
  }
  void clear() {
    kept_.clear();
    count_ = 0;
  }
  std::uint64_t count() const { return count_; }  // of all that it sent
  std::span<const std::uint8_t> kept() const { return kept_; }

 private:
  static constexpr std::size_t most = 8192;
  std::vector<std::uint8_t> kept_;
  std::uint64_t count_ = 0;
};

}  // namespace thermorig::rig
