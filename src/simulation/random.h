// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace thermorig::simulation {

/// Random numbers that depend on nothing but the seed: xoshiro256++ started by splitmix64 (Blackman and
/// Vigna, prng.di.unimi.it), with transforms of our own, because those of <random> differ between standard
/// libraries. Who draws twice in the arguments of one call gets an order that differs between compilers, and
/// another world: each draw there has a line of its own (or stands in braces, which are read in order).
class Random {
 public:
  /// `stream` names the part of the rig that draws: parts with other names draw independent numbers, so that
  /// one more draw in one of them changes nothing in the others.
  Random(std::uint64_t seed, std::string_view stream);

  std::uint64_t bits();
  double uniform();  // [0, 1)
  double uniform(double low, double high);
  int integer(int low, int high);  // low..high, both included
  bool chance(double probability);
  double sign();  // -1 or +1
  double normal();
  double normal(double standard_deviation) { return standard_deviation * normal(); }
  double exponential(double mean);

 private:
  std::array<std::uint64_t, 4> state_{};
  double spare_normal_ = 0.0;
  bool has_spare_normal_ = false;
};

}  // namespace thermorig::simulation
