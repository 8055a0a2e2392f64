// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>

#include "alignment.h"

namespace thermorig::odometer {

/// Where the camera looks in a map that there is: a probability each degree of the circle, half after half.
class CircleSearch {
 public:
  void begin();

  /// A half, and by how much the heading changed since the half before.
  void add(const Alignment& alignment, const View& view, double turned_deg);

  struct Found {
    double azimuth_deg = 0.0;  // of the newest half, 0 to 360
    double sigma_deg = 0.0;
  };
  /// Nothing while more than one place may be it.
  std::optional<Found> found() const;

 private:
  static constexpr std::size_t places = 360;
  std::array<double, places> logs_{};  // of the probabilities
  double shift_deg_ = 0.0;             // what was turned beyond whole degrees
  int halves_ = 0;
};

}  // namespace thermorig::odometer
