// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <random>
#include <string>

namespace thermorig::model {

/// Damages files in ways that reach deep into a reader. The same seed does the same damage.
class Mutation {
 public:
  explicit Mutation(std::uint64_t seed) : random_(seed) {}

  /// One to eight changes: bits flipped, bytes set, the end cut off, ranges doubled, removed, or taken from
  /// `donor`, lengths and numbers (protobuf's varints) inflated.
  std::string of(std::string file, const std::string& donor);

 private:
  std::size_t below(std::size_t limit);
  std::size_t place(const std::string& file);
  void change(std::string& file, const std::string& donor);
  void inflate(std::string& file);

  std::mt19937_64 random_;
};

}  // namespace thermorig::model
