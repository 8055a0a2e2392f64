// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>

#include "heading_filter.h"
#include "thermorig/core/surroundings/turn_path.h"

namespace thermorig::odometer {

/// The last heading that nothing spoke against, and what the gyro alone makes of it since.
class GyroHeading {
 public:
  /// `then`: of the path, where the filter is. `sigma_deg`: of its heading in the map.
  GyroHeading(const TurnPath::Knot& then, const HeadingFilter& filter, double sigma_deg)
      : then_(then),
        heading_deg_(filter.heading_deg()),
        sigma_deg_(sigma_deg),
        bias_dps_(filter.bias_dps()),
        bias_sigma_dps_(filter.sigma(HeadingFilter::bias)),
        scale_(filter.scale_factor()) {}

  double deg(const TurnPath::Knot& now) const { return deg(now, bias_dps_); }
  /// The same with another bias.
  double deg(const TurnPath::Knot& now, double bias_dps) const {
    return heading_deg_ + (now.turned_deg - then_.turned_deg - bias_dps * since_s(now)) / scale_;
  }

  /// The same if degrees are so much longer, `about` one that stays.
  GyroHeading stretched(double length, double about_deg) const {
    GyroHeading other = *this;
    other.heading_deg_ = about_deg + length * (heading_deg_ - about_deg);
    other.scale_ /= length;
    return other;
  }

  /// One standard deviation, that of a bias which begins to change included.
  double sigma_deg(const TurnPath::Knot& now) const {
    return sigma_with(now, bias_sigma_dps_ + bias_change_dps);
  }
  /// The same with another bias, which was learnt later and is known so well, whatever it changed by before.
  double sigma_deg(const TurnPath::Knot& now, double bias_sigma_dps) const {
    return sigma_with(now, std::hypot(bias_sigma_dps, bias_change_dps));
  }

 private:
  static constexpr double least_sigma_deg = 1.0, bias_change_dps = 0.02;
  double since_s(const TurnPath::Knot& now) const { return now.time_s - then_.time_s; }
  double sigma_with(const TurnPath::Knot& now, double bias_sigma_dps) const {
    const double walked_deg2 = square(HeadingFilter::walk_deg) * since_s(now);
    const double unseen_deg2 = std::max(0.0, now.unseen_deg2 - then_.unseen_deg2);
    return std::sqrt(square(sigma_deg_) + square(least_sigma_deg) + walked_deg2 + unseen_deg2 +
                     square(bias_sigma_dps * since_s(now)));
  }

  TurnPath::Knot then_;
  double heading_deg_, sigma_deg_;
  double bias_dps_, bias_sigma_dps_, scale_;
};

}  // namespace thermorig::odometer
