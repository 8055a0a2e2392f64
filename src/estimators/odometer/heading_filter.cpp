// SPDX-License-Identifier: MIT
#include "heading_filter.h"

#include <algorithm>

namespace thermorig::odometer {

namespace {

constexpr double start_sigma_deg = 1e-3;  // the map's origin is the first heading
constexpr double scale_walk = 2e-5, latency_walk_s = 2e-5;
constexpr double least_state_variance = 1e-14;
constexpr double least_root_deg = 1e-6;  // nodes that were begun together have the very same error

}  // namespace

HeadingFilter::HeadingFilter(const Priors& priors) : priors_(priors) {
  state_[heading] = priors.heading_deg;
  state_[bias] = priors.bias_dps;
  state_[scale] = priors.scale;
  state_[latency] = priors.latency_s;
  covariance_[heading][heading] = square(start_sigma_deg);
  covariance_[bias][bias] = square(priors.bias_sigma_dps);
  covariance_[scale][scale] = square(priors.scale_sigma);
  covariance_[bias][scale] = covariance_[scale][bias] = priors.bias_scale_covariance;
  covariance_[latency][latency] = square(priors.latency_sigma_s);
}

void HeadingFilter::predict(double turned_deg, double step_s, double unseen_deg2) {
  const double step_deg = (turned_deg - state_[bias] * step_s) / state_[scale];
  state_[heading] += step_deg;
  const double by_bias = -step_s / state_[scale], by_scale = -step_deg / state_[scale];
  Vector moved;
  for (std::size_t i = 0; i < size; ++i)
    moved[i] = covariance_[heading][i] + by_bias * covariance_[bias][i] + by_scale * covariance_[scale][i];
  const double own = moved[heading] + by_bias * moved[bias] + by_scale * moved[scale];
  for (std::size_t i = 0; i < size; ++i) covariance_[heading][i] = covariance_[i][heading] = moved[i];
  covariance_[heading][heading] = own + square(walk_deg) * step_s + unseen_deg2;
  covariance_[bias][bias] += square(priors_.bias_walk_dps) * step_s;
  covariance_[scale][scale] += square(scale_walk) * step_s;
  covariance_[latency][latency] += square(latency_walk_s) * step_s;
}

double HeadingFilter::exposed_deg(const ExposedTurn& turn, double now_s, double now_deg) const {
  return state_[heading] - (now_deg - turn.mean_deg - state_[bias] * (now_s - turn.mean_s)) / state_[scale];
}

double HeadingFilter::spread_deg(const ExposedTurn& turn) const {
  const double variance =
      turn.variance_deg2 - 2.0 * state_[bias] * turn.covariance + square(state_[bias]) * turn.variance_s2;
  return std::sqrt(std::max(0.0, variance)) / std::abs(state_[scale]);
}

HeadingFilter::Vector HeadingFilter::jacobian(const ExposedTurn& turn, double now_s, double now_deg,
                                              const std::array<double, nodes>& about) const {
  Vector row{};
  const double since_s = now_s - turn.mean_s;
  row[heading] = 1.0;
  row[bias] = since_s / state_[scale];
  row[scale] = (now_deg - turn.mean_deg - state_[bias] * since_s) / square(state_[scale]);
  row[latency] = -mean_rate_dps(turn);
  for (std::size_t node = 0; node < nodes; ++node) row[first_node + node] = -about[node];
  return row;
}

double HeadingFilter::variance(const Vector& jacobian) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t j = 0; j < size; ++j) sum += jacobian[i] * covariance_[i][j] * jacobian[j];
  return std::max(0.0, sum);
}

/// P H^T: the covariance of what was measured with each part of the state.
HeadingFilter::Vector HeadingFilter::cross_covariance(const Vector& jacobian) const {
  Vector cross{};
  for (std::size_t i = 0; i < size; ++i)
    for (std::size_t j = 0; j < size; ++j) cross[i] += covariance_[i][j] * jacobian[j];
  return cross;
}

void HeadingFilter::update(const Vector& jacobian, double innovation, double noise) {
  const Vector cross = cross_covariance(jacobian);
  double total = noise;
  for (std::size_t i = 0; i < size; ++i) total += jacobian[i] * cross[i];
  for (std::size_t i = 0; i < size; ++i) {
    state_[i] += cross[i] / total * innovation;
    for (std::size_t j = 0; j < size; ++j) covariance_[i][j] -= cross[i] * cross[j] / total;
  }
  for (std::size_t i = 0; i < size; ++i)
    if (i < first_node) covariance_[i][i] = std::max(covariance_[i][i], least_state_variance);
}

void HeadingFilter::add_shares(double azimuth_deg, double weight, std::array<double, nodes>& shares) {
  const BetweenNodes at = between_nodes(azimuth_deg);
  shares[at.left] += weight * (1.0 - at.part);
  shares[at.right] += weight * at.part;
}

void HeadingFilter::rewrite(const std::array<double, nodes>& shares, const Vector& shown) {
  for (std::size_t node = 0; node < nodes; ++node) {
    const double share = shares[node];
    if (share <= 0.0) continue;
    const std::size_t at = first_node + node;
    const Vector cross = cross_covariance(shown);
    Vector mixed;
    double of_shown = 0.0;
    for (std::size_t i = 0; i < size; ++i) {
      mixed[i] = (1.0 - share) * covariance_[at][i] + share * cross[i];
      of_shown += shown[i] * mixed[i];
    }
    mixed[at] = (1.0 - share) * mixed[at] + share * of_shown;
    for (std::size_t i = 0; i < size; ++i) covariance_[at][i] = covariance_[i][at] = mixed[i];
  }
}

void HeadingFilter::begin_nodes(double low_deg, double high_deg, const Vector& shown) {
  constexpr auto all = static_cast<long>(nodes);
  const auto last = static_cast<long>(std::ceil(high_deg / node_deg));
  for (auto node = static_cast<long>(std::floor(low_deg / node_deg)); node <= last; ++node) {
    const auto place = static_cast<std::size_t>((node % all + all) % all);
    const double at_deg = static_cast<double>(node) * node_deg;
    const auto now = at_deg >= low_deg && at_deg <= high_deg ? NodeState::seen : NodeState::near;
    if (now <= known_[place]) continue;
    if (known_[place] == NodeState::none) {
      const std::size_t before = (place + nodes - 1) % nodes, behind = (place + 1) % nodes;
      if (known_[before] != NodeState::none)
        state_[first_node + place] = state_[first_node + before];
      else if (known_[behind] != NodeState::none)
        state_[first_node + place] = state_[first_node + behind];
    }
    known_[place] = now;
    begin_node(first_node + place, shown);
  }
}

/// What is seen there first is put where the exposure is thought to look: it is off by as much. That is not
/// what the heading is off: latency moves all halves of one speed alike, and none of them shows it. And it
/// is off by itself, by the noise of the few halves that have drawn it.
void HeadingFilter::begin_node(std::size_t at, const Vector& shown) {
  const Vector cross = cross_covariance(shown);
  for (std::size_t i = 0; i < size; ++i) covariance_[at][i] = covariance_[i][at] = cross[i];
  covariance_[at][at] = variance(shown) + square(priors_.map_sigma_deg);
}

/// The covariance as a root of it, by Cholesky: whatever a file says of a root, it is a covariance's.
void HeadingFilter::keep(Map& map) const {
  std::array<std::array<double, nodes>, nodes> root{};
  std::size_t place = 0;
  for (std::size_t i = 0; i < nodes; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double left = covariance_[first_node + i][first_node + j];
      for (std::size_t k = 0; k < j; ++k) left -= root[i][k] * root[j][k];
      if (i == j)
        root[i][i] = std::sqrt(std::max(0.0, left));
      else
        root[i][j] = root[j][j] > least_root_deg ? left / root[j][j] : 0.0;
      map.offset_root_deg[place++] = root[i][j];
    }
    map.offset_deg[i] = state_[first_node + i];
    map.offset_known[i] = static_cast<std::uint8_t>(known_[i]);
  }
}

void HeadingFilter::load(const Map& map) {
  const auto root = [&](std::size_t i, std::size_t j) {
    return j <= i ? map.offset_root_deg[i * (i + 1) / 2 + j] : 0.0;
  };
  for (std::size_t i = 0; i < nodes; ++i) {
    state_[first_node + i] = map.offset_deg[i];
    known_[i] = static_cast<NodeState>(map.offset_known[i]);
    for (std::size_t other = 0; other < first_node; ++other)
      covariance_[first_node + i][other] = covariance_[other][first_node + i] = 0.0;
    for (std::size_t j = 0; j < nodes; ++j) {
      double sum = 0.0;
      for (std::size_t k = 0; k < nodes; ++k) sum += root(i, k) * root(j, k);
      covariance_[first_node + i][first_node + j] = sum;
    }
  }
}

void HeadingFilter::find_heading(const Vector& exposed, double off_deg, double sigma_deg) {
  for (std::size_t i = 0; i < size; ++i) covariance_[heading][i] = covariance_[i][heading] = 0.0;
  covariance_[heading][heading] = square(0.5 * whole_turn_deg);
  state_[heading] += off_deg;
  update(exposed, 0.0, square(sigma_deg));
}

}  // namespace thermorig::odometer
