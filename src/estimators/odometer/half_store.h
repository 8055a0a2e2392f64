// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "thermorig/core/surroundings/half_frame.h"

namespace thermorig::odometer {

/// The halves of the start, to be gone through again: the first ones, as many as there is room for.
class HalfStore {
 public:
  HalfStore() : halves_(room) {}

  struct Stored {
    HalfFrame half;
    double now_s = 0.0;  // when it came
  };

  void add(const HalfFrame& half, double now_s) {
    if (count_ < room) halves_[count_++] = {half, now_s};
  }
  std::size_t count() const { return count_; }
  bool is_full() const { return count_ == room; }
  const Stored& at(std::size_t place) const { return halves_[place]; }
  void clear() { count_ = 0; }
  void forget(std::size_t first, std::size_t halves) {
    const auto to = halves_.begin() + static_cast<std::ptrdiff_t>(first);
    std::move(to + static_cast<std::ptrdiff_t>(halves), halves_.begin() + static_cast<std::ptrdiff_t>(count_),
              to);
    count_ -= halves;
  }

  static constexpr std::size_t room = 480;  // a minute at 8 halves a second

 private:
  std::vector<Stored> halves_;
  std::size_t count_ = 0;
};

}  // namespace thermorig::odometer
