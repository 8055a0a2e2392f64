// SPDX-License-Identifier: MIT
#include "mosaic.h"

#include <algorithm>
#include <cmath>

#include "thermorig/core/statistics.h"

namespace thermorig::odometer {

namespace {

constexpr double finest_cell_pixels = 2.0;
constexpr float clipped_deviations = 1.0F;  // from the median, in the median of such deviations
constexpr float no_pair = 1e-9F;            // of an empty cell: it can be divided by that

}  // namespace

Mosaic::Mosaic(const SharedLens& lens) : lens_(lens) {
  for (std::size_t i = 0; i < pairs; ++i)
    bearing_turns_[i] =
        static_cast<float>(share_of_turn(0.5 * (lens_->bearing_deg(2 * i) + lens_->bearing_deg(2 * i + 1))));
  placed_.reserve(most_halves);
  read_c_.reserve(pairs * band_rows);
  cells_.reserve(static_cast<std::size_t>(whole_turn_deg / (finest_cell_pixels * lens_->pitch_deg())) + 2);
}

void Mosaic::take(const HalfStore& store, const TurnPath& path) {
  placed_.clear();
  for (std::size_t i = store.count() - std::min(store.count(), most_halves); i < store.count(); ++i) {
    const HalfFrame& half = store.at(i).half;
    if (half.begin_s > path.begin_s()) place(half, path);
  }
  for (std::size_t band = 0; band < bands; ++band) {
    take_off_errors_of_pairs(band);
    all_[band] = Squares();
    for (const Placed& one : placed_)
      for (std::size_t i = 0; i < pairs; ++i) {
        all_[band].readings += double{band_rows * one.of[band].is_read[i]};
        for (const float temp_c : one.of[band].temp_c[i]) all_[band].k2 += square(double{temp_c});
      }
  }
}

double Mosaic::spanned_s() const {
  return std::max(1.0, placed_.back().mean_s - placed_.front().mean_s);
}

double Mosaic::turned_deg() const {
  const auto [least, most] =
      std::minmax_element(placed_.begin(), placed_.end(),
                          [](const Placed& a, const Placed& b) { return a.mean_deg < b.mean_deg; });
  return most->mean_deg - least->mean_deg;
}

double Mosaic::mean_read_dps() const {
  return (placed_.back().mean_deg - placed_.front().mean_deg) / spanned_s();
}

void Mosaic::place(const HalfFrame& half, const TurnPath& path) {
  const ExposedTurn turn = path.over(half.begin_s, half.end_s);
  Placed& placed = placed_.emplace_back(Placed{.of = {},
                                               .parity = half.parity,
                                               .period_s = half.end_s - half.begin_s,
                                               .mean_s = turn.mean_s,
                                               .mean_deg = turn.mean_deg,
                                               .read_dps = turn.mean_read_dps()});
  for (std::size_t n = 0; n < bands; ++n) {
    Band& band = placed.of[n];
    for (std::size_t i = 0; i < pairs; ++i) {
      const float* const left = &half.temp_c[2 * i * half_rows + n * band_rows];
      const float* const right = left + half_rows;
      float of_pair = 0.0F;
      for (std::size_t k = 0; k < band_rows; ++k) of_pair += band.temp_c[i][k] = 0.5F * (left[k] + right[k]);
      band.is_read[i] = std::isnan(of_pair) ? 0.0F : 1.0F;
    }
    clip(band);
  }
}

/// About what all have in common. Something warm that moves would make the sharpest mosaic by itself.
void Mosaic::clip(Band& band) {
  read_c_.clear();
  for (std::size_t i = 0; i < pairs; ++i)
    if (band.is_read[i] > 0.0F) read_c_.insert(read_c_.end(), band.temp_c[i].begin(), band.temp_c[i].end());
  const float common_c = reordering_median(read_c_);
  for (float& temp_c : read_c_) temp_c = std::abs(temp_c - common_c);
  const float most_c = clipped_deviations * reordering_median(read_c_);
  for (std::size_t i = 0; i < pairs; ++i)
    for (float& temp_c : band.temp_c[i])
      temp_c = band.is_read[i] > 0.0F ? std::clamp(temp_c - common_c, -most_c, most_c) : 0.0F;
}

/// What a pair shows on average beyond its neighbours is its own error. Otherwise the mosaic is sharpest
/// where nothing seems to move.
void Mosaic::take_off_errors_of_pairs(std::size_t band) {
  for (const unsigned parity : {0U, 1U}) {
    std::array<Pair, pairs + 2> mean{};
    float count = no_pair;
    for (const Placed& one : placed_) {
      if (one.parity != parity) continue;
      count += 1.0F;
      for (std::size_t i = 0; i < pairs; ++i)
        for (std::size_t k = 0; k < band_rows; ++k) mean[i + 1][k] += one.of[band].temp_c[i][k];
    }
    mean.front() = mean[1];
    mean.back() = mean[pairs];
    for (Placed& one : placed_) {
      if (one.parity != parity) continue;
      for (std::size_t i = 0; i < pairs; ++i)
        for (std::size_t k = 0; k < band_rows; ++k) {
          const float about = 0.5F * (mean[i][k] + mean[i + 2][k]);
          one.of[band].temp_c[i][k] -= one.of[band].is_read[i] * (mean[i + 1][k] - about) / count;
        }
    }
  }
}

double Mosaic::log_likelihood(const Hypothesis& hypothesis, double cell_pixels) {
  Squares within;
  add_within_cells(hypothesis, middle, cell_pixels, within);
  return within.log_likelihood();
}

double Mosaic::log_likelihood_of_bands(const Hypothesis& hypothesis, double cell_pixels) {
  Squares within;
  for (std::size_t band = 0; band < bands; ++band) add_within_cells(hypothesis, band, cell_pixels, within);
  return within.log_likelihood();
}

double Mosaic::Squares::log_likelihood() const {
  constexpr double least_k2 = 1e-6;  // of images that are all the same
  return -0.5 * readings * std::log(std::max(least_k2, k2) / std::max(1.0, readings - cells));
}

/// How much later than the middle rows a band is exposed, in refresh periods: the mean of its middle rows.
double Mosaic::band_delay_periods(RowOrder order, std::size_t band) const {
  constexpr std::size_t rows = frame_rows / bands;
  const std::size_t below = band * rows + rows / 2;
  return 0.5 * (lens_->row_delay_periods(order, below - 1) + lens_->row_delay_periods(order, below));
}

/// Of a band's readings within the cells: their squares, which no hypothesis changes, less those of means.
void Mosaic::add_within_cells(const Hypothesis& hypothesis, std::size_t band, double cell_pixels,
                              Squares& within) {
  const auto all = static_cast<std::size_t>(std::ceil(whole_turn_deg / (cell_pixels * lens_->pitch_deg())));
  const auto all_cells = static_cast<float>(all);
  const double delay_periods = band_delay_periods(hypothesis.order, band);
  cells_.assign(all + 1, Cell());
  for (const Placed& one : placed_) {
    const double turned_deg = (one.mean_deg - hypothesis.bias_dps * one.mean_s) / hypothesis.scale;
    const double rate_dps = (one.read_dps - hypothesis.bias_dps) / hypothesis.scale;
    const double late_s = hypothesis.latency_s - delay_periods * one.period_s;
    const auto turns = static_cast<float>(share_of_turn(turned_deg - late_s * rate_dps));
    const Band& looked = one.of[band];
    for (std::size_t i = 0; i < pairs; ++i) {
      float azimuth_turns = turns + bearing_turns_[i];
      azimuth_turns -= azimuth_turns >= 1.0F ? 1.0F : 0.0F;
      Cell& cell = cells_[static_cast<std::size_t>(azimuth_turns * all_cells)];
      for (std::size_t k = 0; k < band_rows; ++k) cell.sum[k] += looked.temp_c[i][k];
      cell.count += looked.is_read[i];
    }
  }
  within.k2 += all_[band].k2;
  within.readings += all_[band].readings;
  for (const Cell& cell : cells_) {
    if (cell.count == 0.0F) continue;
    within.cells += band_rows;
    for (const float sum : cell.sum) within.k2 -= double{sum * sum / cell.count};
  }
}

}  // namespace thermorig::odometer
