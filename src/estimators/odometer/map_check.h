// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "tracker.h"

namespace thermorig::odometer {

/// Whether a map that was made before is of these surroundings: what halves show from left to right must be
/// explained by it, over more than one view.
class MapCheck {
 public:
  void begin() { *this = MapCheck(); }
  void add(const HalfResult& result, double heading_deg);

  enum class Verdict : std::uint8_t { open, same, other };
  Verdict verdict() const;

 private:
  double left_ = 0.0, structure_ = 0.0;  // squares of pixels beyond their noise
  double lowest_deg_ = 0.0, highest_deg_ = 0.0, last_deg_ = 0.0;
  int views_ = 0, used_ = 0;
};

}  // namespace thermorig::odometer
