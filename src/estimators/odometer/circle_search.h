// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
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
    /// By how many standard deviations another azimuth is off it.
    double sigmas_to(double other_deg) const {
      return std::remainder(other_deg - azimuth_deg, whole_turn_deg) / sigma_deg;
    }
  };
  /// Nothing while more than one place may be it. `by_gyro`: where a gyro that was there all along has the
  /// newest half, if it was: a place that it cannot have come to is not found, however well it fits.
  std::optional<Found> found(const std::optional<Found>& by_gyro) const;

 private:
  static constexpr std::size_t places = 360;
  using Logs = std::array<double, places>;
  Logs with(const Found& by_gyro) const;

  Logs logs_{};             // of the probabilities
  double shift_deg_ = 0.0;  // what was turned beyond whole degrees
  int halves_ = 0;
};

}  // namespace thermorig::odometer
