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
  /// Bits of one of so many symmetries (2 or 8) of network::Turn.
  std::uint8_t turn(int symmetries) {
    return static_cast<std::uint8_t>(bits() >> (symmetries == 2 ? 63U : 61U));
  }
  /// 0 up to 1.
  double share() { return static_cast<double>(bits() >> 11U) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * share(); }
  bool happens(double probability) { return share() < probability; }
  /// Mean 0, deviation 1 (Box and Muller 1958).
  double normal();
  /// All orders of magnitude between the two, both above 0, equally likely.
  double magnitude(double low, double high);
  /// 0 .. count - 1, all equally likely. `count` at least 1.
  std::uint64_t below(std::uint64_t count);

 private:
  std::uint64_t state_;
};

}  // namespace thermorig::training
