// SPDX-License-Identifier: MIT
#include "draw.h"

#include <cmath>
#include <numbers>

namespace thermorig::training {

namespace {

std::uint64_t mixed(std::uint64_t value) {
  value = (value ^ (value >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  value = (value ^ (value >> 27U)) * 0x94D049BB133111EBULL;
  return value ^ (value >> 31U);
}

constexpr std::uint64_t golden_gamma = 0x9E3779B97F4A7C15ULL;

}  // namespace

Draw::Draw(std::uint64_t seed, std::string_view purpose, std::uint64_t epoch)
    : state_(mixed(seed + golden_gamma)) {
  for (const char letter : purpose)
    state_ = mixed(state_ ^ static_cast<unsigned char>(letter)) + golden_gamma;
  state_ = mixed(state_ ^ epoch);
}

std::uint64_t Draw::bits() {
  state_ += golden_gamma;
  return mixed(state_);
}

double Draw::normal() {
  const double size = std::sqrt(-2.0 * std::log(1.0 - share()));
  return size * std::cos(2.0 * std::numbers::pi * share());
}

double Draw::magnitude(double low, double high) {
  return low * std::exp(share() * std::log(high / low));
}

std::uint64_t Draw::below(std::uint64_t count) {
  const std::uint64_t uneven = (0 - count) % count;  // 2^64 mod count: so many numbers would come too often
  std::uint64_t drawn = bits();
  while (drawn < uneven) drawn = bits();
  return drawn % count;
}

}  // namespace thermorig::training
