// SPDX-License-Identifier: MIT
#include "circle_search.h"

#include <algorithm>
#include <cmath>

namespace thermorig::odometer {

namespace {

constexpr double trusted_of_half = 0.2;  // of a half's likelihood: the next one sees the same surroundings
constexpr double forgotten = 0.97;       // a half: what came before counts a little less
constexpr int fewest_halves = 6;
constexpr int reach_deg = 4;          // degrees to either side that belong to one place
constexpr double impossible = -1e30;  // logarithm
constexpr double sure = 0.999;
constexpr double most_off_sigmas = 4.0;  // of what the gyro says
constexpr double most_against = 7.0;     // logarithm: by as much another place may fit better

}  // namespace

void CircleSearch::begin() {
  *this = CircleSearch();
}

void CircleSearch::add(const Alignment& alignment, const View& view, double turned_deg) {
  shift_deg_ += turned_deg;
  const double whole_deg = std::round(shift_deg_);
  shift_deg_ -= whole_deg;
  const auto turn = static_cast<long>(whole_deg) % long{places};
  const auto forward = static_cast<std::size_t>((turn + long{places}) % long{places});
  std::rotate(logs_.begin(), logs_.end() - static_cast<std::ptrdiff_t>(forward), logs_.end());
  double best = impossible;
  for (std::size_t i = 0; i < places; ++i) {
    const double squares = alignment.squares(view, static_cast<double>(i) + shift_deg_);
    logs_[i] = forgotten * logs_[i] - 0.5 * trusted_of_half * squares;
    best = std::max(best, logs_[i]);
  }
  for (double& one : logs_) one -= best;
  ++halves_;
}

CircleSearch::Logs CircleSearch::with(const Found& by_gyro) const {
  Logs logs;
  for (std::size_t i = 0; i < places; ++i) {
    const double sigmas = by_gyro.sigmas_to(static_cast<double>(i) + shift_deg_);
    logs[i] = std::abs(sigmas) > most_off_sigmas ? impossible : logs_[i] - 0.5 * sigmas * sigmas;
  }
  const double best = *std::max_element(logs.begin(), logs.end());
  for (double& one : logs) one -= best;
  return logs;
}

std::optional<CircleSearch::Found> CircleSearch::found(const std::optional<Found>& by_gyro) const {
  if (halves_ < fewest_halves) return std::nullopt;
  const Logs logs = by_gyro ? with(*by_gyro) : logs_;
  const auto best = static_cast<int>(std::max_element(logs.begin(), logs.end()) - logs.begin());
  if (logs_[static_cast<std::size_t>(best)] < -most_against) return std::nullopt;
  double all = 0.0, near = 0.0, mean = 0.0, squares = 0.0;
  for (int i = 0; i < int{places}; ++i) {
    const double weight = std::exp(logs[static_cast<std::size_t>(i)]);
    const double off = std::remainder(i - best, double{places});
    all += weight;
    if (std::abs(off) > reach_deg) continue;
    near += weight;
    mean += weight * off;
    squares += weight * off * off;
  }
  if (near < sure * all) return std::nullopt;
  mean /= near;
  return Found{best + mean + shift_deg_, std::sqrt(std::max(0.0, squares / near - mean * mean)) + 0.5};
}

}  // namespace thermorig::odometer
