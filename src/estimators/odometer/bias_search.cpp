// SPDX-License-Identifier: MIT
#include "bias_search.h"

#include <algorithm>
#include <cmath>

namespace thermorig::odometer {

namespace {

constexpr double step_dps = 0.5;
constexpr std::size_t most_steps = 121;
constexpr double most_sigmas = 3.0;
constexpr double trusted_of_mosaic =
    0.3;  // of the mosaic's likelihood: halves are blurred, pixels have offsets
constexpr double known_well_dps = 1.0;

}  // namespace

BiasSearch::BiasSearch(const Priors& priors, const Lens& lens)
    : priors_(priors),
      lens_(lens),
      cells_a_row_(static_cast<std::size_t>(std::ceil(whole_turn_deg / lens.pitch_deg))),
      placed_(halves),
      cells_(cells_a_row_ * frame_rows),
      variances_(most_steps) {}

/// Of the readings within the cells of the mosaic.
double BiasSearch::variance_with(double bias_dps) {
  std::fill(cells_.begin(), cells_.end(), Cell());
  const ExposedTurn& first = placed_.front().turn;
  for (const Placed& one : placed_) {
    const double turned_deg =
        (one.turn.mean_deg - first.mean_deg - bias_dps * (one.turn.mean_s - first.mean_s)) / priors_.scale;
    for (std::size_t column = 0; column < frame_columns; ++column) {
      const double turns = (turned_deg + lens_.bearing_deg(column)) / whole_turn_deg;
      const auto cell =
          std::min(cells_a_row_ - 1,
                   static_cast<std::size_t>((turns - std::floor(turns)) * static_cast<double>(cells_a_row_)));
      Cell* cells = &cells_[cell * frame_rows + row_class(column, one.half->parity)];
      for (std::size_t k = 0; k < half_rows; ++k) {
        const float temp_c = one.half->temp_c[column * half_rows + k] - one.common_c;
        if (std::isnan(temp_c)) continue;
        Cell& at = cells[2 * k];
        at.sum += temp_c;
        at.squares += temp_c * temp_c;
        at.count += 1.0F;
      }
    }
  }
  double squares = 0.0, freedom = 1.0;
  for (const Cell& cell : cells_) {
    if (cell.count < 2.0F) continue;
    squares += double{cell.squares - cell.sum * cell.sum / cell.count};
    freedom += double{cell.count} - 1.0;
  }
  return squares / freedom;
}

std::optional<BiasSearch::Found> BiasSearch::search(const HalfStore& store, const GyroPath& path) {
  if (store.count() < halves) return std::nullopt;
  for (std::size_t i = 0; i < halves; ++i) {
    const HalfReading& half = store.at(store.count() - halves + i).half;
    float sum = 0.0F, count = 1e-3F;
    for (const float temp_c : half.temp_c) {
      if (std::isnan(temp_c)) continue;
      sum += temp_c;
      count += 1.0F;
    }
    placed_[i] = {&half, path.over(half.begin_s, half.end_s), sum / count};
  }
  const double reach_dps = std::min(most_sigmas * priors_.bias_sigma_dps, 0.5 * (most_steps - 1) * step_dps);
  const auto steps = static_cast<int>(reach_dps / step_dps);
  double least = 1e30;
  for (int i = -steps; i <= steps; ++i) {
    double& variance = variances_[static_cast<std::size_t>(i + steps)];
    variance = variance_with(priors_.bias_dps + i * step_dps);
    least = std::min(least, variance);
  }
  const double readings = trusted_of_mosaic * 0.5 * static_cast<double>(halves * half_pixels);
  double sum = 0.0, mean = 0.0, squares = 0.0;
  for (int i = -steps; i <= steps; ++i) {
    const double off = i * step_dps / priors_.bias_sigma_dps;
    const double weight = std::exp(
        -readings * (variances_[static_cast<std::size_t>(i + steps)] / least - 1.0) - 0.5 * off * off);
    sum += weight;
    mean += weight * i * step_dps;
    squares += weight * i * step_dps * i * step_dps;
  }
  mean /= sum;
  const double sigma_dps = std::sqrt(squares / sum - mean * mean + step_dps * step_dps / 12.0);
  if (sigma_dps > known_well_dps) return std::nullopt;
  return Found{priors_.bias_dps + mean, sigma_dps};
}

}  // namespace thermorig::odometer
