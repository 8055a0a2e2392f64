// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "thermorig/core/surroundings/half_frame.h"
#include "thermorig/core/surroundings/turn_path.h"
#include "thermorig/estimators/odometer/map.h"

namespace thermorig::odometer {

/// What is known before anything was measured, one standard deviation each.
struct Priors {
  double heading_deg = 0.0;  // of the map's origin
  double bias_dps = 0.0, bias_sigma_dps = 20.0;
  double scale = 1.0, scale_sigma = 0.03;
  double bias_scale_covariance = 0.0;               // deg/s
  double latency_s = 0.0, latency_sigma_s = 0.010;  // of the camera against the gyro
  double map_sigma_deg = 0.0;                       // of a part of the map by itself
  double bias_walk_dps = 0.008;                     // in a square root of a second
};

/// An extended Kalman filter with scalar measurements. Its state: heading (deg), gyro bias (deg/s), gyro
/// scale, camera latency (s), and the map's offset at nodes 15 degrees apart, whose errors are those that the
/// heading had when they were first seen.
class HeadingFilter {
 public:
  static constexpr std::size_t nodes = Map::nodes;
  static constexpr double node_deg = whole_turn_deg / nodes;
  enum Place : std::size_t { heading, bias, scale, latency, first_node };
  static constexpr std::size_t size = first_node + nodes;
  using Vector = std::array<double, size>;
  static constexpr double walk_deg = 0.03;  // of the heading in a square root of a second: noise of the gyro

  explicit HeadingFilter(const Priors& priors);

  double heading_deg() const { return state_[heading]; }
  /// The heading at which it began, and the map with it.
  double begun_deg() const { return priors_.heading_deg; }
  double bias_dps() const { return state_[bias]; }
  double scale_factor() const { return state_[scale]; }
  double latency_s() const { return state_[latency]; }
  double sigma(Place place) const { return std::sqrt(covariance_[place][place]); }

  /// Time update: the gyro turned by so much, in so long. `unseen_deg2`: process noise of lost samples.
  void predict(double turned_deg, double step_s, double unseen_deg2);

  /// The heading in the middle of an exposure: what a measurement is compared with. `now`: the newest point
  /// of the gyro's path, to which the state belongs.
  double exposed_deg(const ExposedTurn& turn, double now_s, double now_deg) const;
  /// One standard deviation of the headings in it.
  double spread_deg(const ExposedTurn& turn) const;
  double mean_rate_dps(const ExposedTurn& turn) const {
    return (turn.mean_read_dps() - state_[bias]) / state_[scale];
  }

  /// The Jacobian of exposed_deg(), less the map's offset there, by the state (H). `about`: the weight of
  /// each node's offset; none: of exposed_deg() alone.
  Vector jacobian(const ExposedTurn& turn, double now_s, double now_deg,
                  const std::array<double, nodes>& about = {}) const;
  double variance(const Vector& jacobian) const;  // H P H^T
  /// Measurement update. `noise`: variance of the measurement.
  void update(const Vector& jacobian, double innovation, double noise);

  /// How the map is off there: between its nodes a straight line.
  double map_offset_deg(double azimuth_deg) const {
    const BetweenNodes at = between_nodes(azimuth_deg);
    const double left_deg = state_[first_node + at.left];
    return left_deg + at.part * (state_[first_node + at.right] - left_deg);
  }
  /// Shares of the nodes in map_offset_deg().
  static void add_shares(double azimuth_deg, double weight, std::array<double, nodes>& shares);
  /// The map was written again where the newest half was `shown`: about each node so much of it, 0 to 1, is
  /// off as that is from now on.
  void rewrite(const std::array<double, nodes>& shares, const Vector& shown);
  /// The map has a gap: it was never seen whether it closes.
  bool has_gap() const {
    return std::any_of(known_.begin(), known_.end(), [](NodeState one) { return one != NodeState::seen; });
  }
  /// Nodes that a half from `low_deg` to `high_deg` first shows begin with the error of where it is put.
  /// `shown`: jacobian() of where it is put, without a map.
  void begin_nodes(double low_deg, double high_deg, const Vector& shown);

  /// How the map is off, and how well that is known.
  void keep(Map& map) const;
  /// The heading is not known in it yet: find_heading() comes next.
  void load(const Map& map);

  /// An exposure was found to look `off_deg` beside where it was expected: the heading is forgotten, and no
  /// surer from then on than how late that exposure is. `exposed`: jacobian() of it, without a map.
  void find_heading(const Vector& exposed, double off_deg, double sigma_deg);
  /// Bias and latency may be others than they were.
  void widen(double bias_variance_dps2, double latency_variance_s2) {
    covariance_[bias][bias] += bias_variance_dps2;
    covariance_[latency][latency] += latency_variance_s2;
  }

 private:
  struct BetweenNodes {
    std::size_t left, right;
    double part;  // of the way from left to right
  };
  static BetweenNodes between_nodes(double azimuth_deg) {
    const double position = share_of_turn(azimuth_deg) * static_cast<double>(nodes);
    const auto whole = static_cast<std::size_t>(position);
    const std::size_t left = whole < nodes ? whole : 0;
    return {left, left + 1 < nodes ? left + 1 : 0, position - static_cast<double>(whole)};
  }
  Priors priors_;
  Vector state_{};
  std::array<Vector, size> covariance_{};
  enum class NodeState : std::uint8_t { none, near, seen };  // near: only what lies between it and the next
  std::array<NodeState, nodes> known_{};
  Vector cross_covariance(const Vector& jacobian) const;
  void begin_node(std::size_t at, const Vector& shown);
};

}  // namespace thermorig::odometer
