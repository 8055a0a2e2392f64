// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string_view>

namespace thermorig::training {

/// Random numbers of a training: splitmix64 (Steele, Lea, Flood 2014), the same on every machine. Each
/// purpose and epoch has a sequence of its own, so that going on with a later epoch needs no state.
class Draw {
 public:
  Draw(std::uint64_t seed, std::string_view purpose, std::uint64_t epoch = 0);

  std::uint64_t bits();
  bool coin() { return (bits() >> 63U) != 0; }
  /// 0 .. count - 1, all equally likely. `count` at least 1.
  std::uint64_t below(std::uint64_t count);

 private:
  std::uint64_t state_;
};

}  // namespace thermorig::training
