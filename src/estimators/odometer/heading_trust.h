// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "heading_filter.h"
#include "thermorig/core/surroundings/turn_path.h"
#include "tracker.h"

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

/// Whether a heading is believed. One that a search found must prove itself first; where the gyro says
/// something else and was there all the time, one of the two is wrong, and as long as the rig keeps its speed
/// nobody can tell which.
class HeadingTrust {
 public:
  HeadingTrust() = default;

  /// Of a heading that nothing speaks against.
  void begin(double rate_dps) { *this = {0, false, rate_dps}; }
  /// Of one that a search found, or that the gyro alone has carried here.
  void begin_unproven(double rate_dps, bool gyro_differs) {
    *this = {gyro_differs ? halves_to_trust_doubted : halves_to_trust, gyro_differs, rate_dps};
  }
  /// Of one in a map of before: only halves at another speed tell. For a slow rig a rest is one.
  void begin_in_map(double rate_dps) {
    begin_unproven(rate_dps, true);
    change_dps_ = std::clamp(0.75 * std::abs(rate_dps), least_change_dps, telling_change_dps);
  }
  /// Innovations lie to one side where things move.
  void doubt_one_sided() { halves_left_ = halves_to_trust_doubted; }

  /// Of a half that was judged.
  void add(const HalfResult& result) {
    slowest_dps_ = std::min(slowest_dps_, result.rate_dps);
    fastest_dps_ = std::max(fastest_dps_, result.rate_dps);
    if (gyro_differs_ && std::abs(result.rate_dps - begun_dps_) < change_dps_) return;
    if (result.is_used) halves_left_ = std::max(0, halves_left_ - 1);
    if (halves_left_ == 0) gyro_differs_ = false;
  }

  bool is_trusted() const { return halves_left_ == 0; }
  /// So much that a wrong time would have shown.
  bool has_changed_speed() const { return fastest_dps_ - slowest_dps_ >= telling_change_dps; }

 private:
  static constexpr int halves_to_trust = 8, halves_to_trust_doubted = 16;
  static constexpr double telling_change_dps = 40.0, least_change_dps = 10.0;

  HeadingTrust(int halves, bool gyro_differs, double rate_dps)
      : halves_left_(halves),
        gyro_differs_(gyro_differs),
        begun_dps_(rate_dps),
        slowest_dps_(rate_dps),
        fastest_dps_(rate_dps) {}

  int halves_left_ = 0;
  bool gyro_differs_ = false;
  double begun_dps_ = 0.0;                        // the speed at which it was found
  double change_dps_ = telling_change_dps;        // what another speed is
  double slowest_dps_ = 0.0, fastest_dps_ = 0.0;  // since it began
};

/// Whether a map that was made before is of these surroundings: what halves show from left to right must be
/// explained by it, over more than one view.
class MapCheck {
 public:
  void begin() { *this = MapCheck(); }

  /// A rig at rest shows one view again and again, which may be like another one of any room.
  void add(const HalfResult& result, double heading_deg) {
    if (!result.is_judged) return;
    if (views_ > 0 && std::abs(heading_deg - last_deg_) < view_deg) return;
    if (views_++ == 0) lowest_deg_ = highest_deg_ = heading_deg;
    last_deg_ = heading_deg;
    lowest_deg_ = std::min(lowest_deg_, heading_deg);
    highest_deg_ = std::max(highest_deg_, heading_deg);
    left_ += result.explained.left;
    structure_ += result.explained.structure;
    used_ += result.is_used ? 1 : 0;
  }

  enum class Verdict : std::uint8_t { open, same, other };
  Verdict verdict() const {
    const bool tells = views_ >= fewest_views && structure_ >= least_structure * views_;
    if (!tells || highest_deg_ - lowest_deg_ < range_deg) return Verdict::open;
    if (left_ > left_of_other * structure_ || used_ < used_of_same * views_) return Verdict::other;
    return left_ < left_of_same * structure_ ? Verdict::same : Verdict::open;
  }

 private:
  static constexpr double view_deg = 5.0;  // a view that was turned by as much is another one
  static constexpr int fewest_views = 32;  // 4 s at 8 halves a second
  static constexpr double range_deg = 60.0;
  static constexpr double least_structure = 40.0;  // of a half: before walls all maps are alike
  static constexpr double left_of_same = 0.08, left_of_other = 0.2;  // of the structure: what is left of it
  static constexpr double used_of_same = 0.7;                        // share of the halves

  double left_ = 0.0, structure_ = 0.0;  // squares of pixels beyond their noise
  double lowest_deg_ = 0.0, highest_deg_ = 0.0, last_deg_ = 0.0;
  int views_ = 0, used_ = 0;
};

}  // namespace thermorig::odometer
