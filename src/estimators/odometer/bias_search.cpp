// SPDX-License-Identifier: MIT
#include "bias_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace thermorig::odometer {

namespace {

constexpr double finest_step_dps = 0.5, coarse_step_dps = 1.0;  // the coarse one where rows are dear
constexpr double trusted_of_mosaic =
    0.3;  // of the mosaic's likelihood: halves are blurred, pixels have offsets
constexpr double known_well_dps = 1.0;
constexpr double distinct_share = 0.94;  // of the typical variance: noise alone makes it differ by 2 %

constexpr float clip_of_mean = 1.5F, least_clip_c = 0.8F;  // of a half's mean difference from its mean
constexpr float largest_error_c = 3.0F;                    // of a pixel that is not broken
constexpr float unknown_c = std::numeric_limits<float>::quiet_NaN();

constexpr std::size_t lanes_of_row = 8;  // of the sums over a row's cells
constexpr float no_readings = 1e-9F;     // of an empty cell: it can be divided by that

/// Mean of each pixel less that of those about it.
HalfPixels beyond_neighbours(const HalfPixels& sum, const HalfPixels& count) {
  constexpr long columns = frame_columns, rows = half_rows;
  HalfPixels beyond;
  for (long column = 0; column < columns; ++column)
    for (long row = 0; row < rows; ++row) {
      float about = 0.0F, number = 0.0F;
      for (long c = std::max(0L, column - 2); c <= std::min(columns - 1, column + 2); ++c)
        for (long r = std::max(0L, row - 1); r <= std::min(rows - 1, row + 1); ++r) {
          const auto i = static_cast<std::size_t>(c * rows + r);
          if ((c == column && r == row) || count[i] <= 0.0F) continue;
          about += sum[i] / count[i];
          number += 1.0F;
        }
      const auto i = static_cast<std::size_t>(column * rows + row);
      beyond[i] = count[i] > 0.0F && number > 0.0F ? sum[i] / count[i] - about / number : 0.0F;
    }
  return beyond;
}

}  // namespace

/// In lanes, which lie beside each other in memory.
template <std::size_t lanes>
struct BiasSearch::MosaicSums {
  std::array<double, lanes> of_means{};
  std::array<int, lanes> used{};

  void add(const float* sum, const float* count) {
    for (std::size_t k = 0; k < lanes; ++k) {
      of_means[k] += double{sum[k] * sum[k] / count[k]};
      used[k] += count[k] > no_readings ? 1 : 0;
    }
  }
  Mosaic all() const {
    return {std::accumulate(of_means.begin(), of_means.end(), 0.0),
            static_cast<double>(std::accumulate(used.begin(), used.end(), 0))};
  }
};

BiasSearch::BiasSearch(const Priors& priors, const SharedLens& lens)
    : priors_(priors),
      lens_(lens),
      cells_a_row_(static_cast<std::size_t>(std::ceil(whole_turn_deg / lens->pitch_deg()))),
      placed_(halves),
      cells_(2 * cells_a_row_),
      row_readings_(halves),
      row_sum_((cells_a_row_ + lanes_of_row - 1) / lanes_of_row * lanes_of_row),
      row_count_(row_sum_.size()),
      mosaics_(most_steps),
      variances_(most_steps),
      ordered_(most_steps) {
  for (std::size_t column = 0; column < frame_columns; ++column)
    bearing_cells_[column] =
        static_cast<float>(lens_->bearing_deg(column) / whole_turn_deg) * static_cast<float>(cells_a_row_);
}

/// Where in a row of cells, not rounded, from 0 on.
float BiasSearch::cell_of(double azimuth_deg) const {
  return static_cast<float>(share_of_turn(azimuth_deg)) * static_cast<float>(cells_a_row_);
}

/// `cell`: at most a turn beyond the row of cells, to either side.
int BiasSearch::index_of(float cell) const {
  const auto all = static_cast<int>(cells_a_row_);
  int index = static_cast<int>(cell + static_cast<float>(all));  // not below 0
  index -= index >= 2 * all ? all : 0;
  return index - (index >= all ? all : 0);
}

void BiasSearch::add_columns(const Placed& one, double turned_deg) {
  const float turned_cells = cell_of(turned_deg);
  for (std::size_t column = 0; column < frame_columns; ++column) {
    const auto azimuth = static_cast<std::size_t>(index_of(turned_cells + bearing_cells_[column]));
    Cells& cells = cells_[2 * azimuth + row_class(column, one.parity)];
    const float* const temp_c = &one.temp_c[column * half_rows];
    const float* const is_read = &one.is_read[column * half_rows];
    for (std::size_t k = 0; k < half_rows; ++k) {
      cells.sum[k] += temp_c[k];
      cells.count[k] += is_read[k];
    }
  }
}

BiasSearch::Mosaic BiasSearch::mosaic_with(double bias_dps) {
  constexpr auto empty = [] {
    Cells cells;
    cells.count.fill(no_readings);
    return cells;
  }();
  std::fill(cells_.begin(), cells_.end(), empty);
  const ExposedTurn& first = placed_.front().turn;
  for (const Placed& one : placed_)
    add_columns(one, (one.turn.mean_deg - first.mean_deg - bias_dps * (one.turn.mean_s - first.mean_s)) /
                         priors_.scale);
  MosaicSums<half_rows> sums;
  for (const Cells& cells : cells_) sums.add(cells.sum.data(), cells.count.data());
  return sums.all();
}

void BiasSearch::gather_row(std::size_t row) {
  const ExposedTurn& first = placed_.front().turn;
  for (std::size_t i = 0; i < halves; ++i) {
    const Placed& placed = placed_[i];
    RowReadings& readings = row_readings_[i];
    readings.later_s = placed.turn.mean_s - first.mean_s + placed.later_s[row];
    readings.later_deg = placed.turn.mean_deg - first.mean_deg + placed.later_deg[row];
    std::size_t column = row_class(row, placed.parity);
    for (std::size_t k = 0; k < looks_a_row; ++k, column += row_stride) {
      readings.temp_c[k] = placed.temp_c[column * half_rows + row / 2];
      readings.is_read[k] = placed.is_read[column * half_rows + row / 2];
      readings.bearing_cells[k] = bearing_cells_[column];
    }
  }
}

void BiasSearch::add_row(std::size_t row, const Biases& biases) {
  gather_row(row);
  for (std::size_t i = 0; i < biases.count; ++i) {
    const Mosaic of_row = row_mosaic_with(biases.dps(i));
    mosaics_[i].of_means += of_row.of_means;
    mosaics_[i].used += of_row.used;
  }
}

BiasSearch::Mosaic BiasSearch::row_mosaic_with(double bias_dps) {
  std::fill(row_sum_.begin(), row_sum_.end(), 0.0F);
  std::fill(row_count_.begin(), row_count_.end(), no_readings);
  for (const RowReadings& one : row_readings_) {
    const float turned_cells = cell_of((one.later_deg - bias_dps * one.later_s) / priors_.scale);
    std::array<int, looks_a_row> azimuths{};  // by themselves: all at a time
    for (std::size_t k = 0; k < looks_a_row; ++k) azimuths[k] = index_of(turned_cells + one.bearing_cells[k]);
    for (std::size_t k = 0; k < looks_a_row; ++k) {
      row_sum_[static_cast<std::size_t>(azimuths[k])] += one.temp_c[k];
      row_count_[static_cast<std::size_t>(azimuths[k])] += one.is_read[k];
    }
  }
  MosaicSums<lanes_of_row> sums;
  for (std::size_t i = 0; i < row_sum_.size(); i += lanes_of_row) sums.add(&row_sum_[i], &row_count_[i]);
  return sums.all();
}

/// Of the readings within the cells of the mosaic: their squares, which no bias changes, less those of means.
double BiasSearch::variance(const Mosaic& mosaic) const {
  return (squares_ - mosaic.of_means) / (readings_ - mosaic.used + 1.0);
}

void BiasSearch::note_readings() {
  squares_ = readings_ = 0.0;
  for (Placed& one : placed_)
    for (std::size_t column = 0; column < frame_columns; ++column)
      for (std::size_t k = 0; k < half_rows; ++k) {
        float& temp_c = one.temp_c[column * half_rows + k];
        const bool is_read = !std::isnan(temp_c);
        one.is_read[column * half_rows + k] = is_read ? 1.0F : 0.0F;
        if (!is_read) temp_c = 0.0F;
        const bool is_looked_at = rows_ == RowOrder::at_once || column % row_stride < 2;
        if (!is_looked_at) continue;
        squares_ += square(double{temp_c});
        readings_ += is_read ? 1.0 : 0.0;
      }
}

void BiasSearch::place(const HalfStore& store, const GyroPath& path) {
  for (std::size_t i = 0; i < halves; ++i) {
    const HalfReading& half = store.at(store.count() - halves + i).half;
    Placed& placed = placed_[i];
    placed = {.temp_c = half.temp_c, .parity = half.parity, .turn = path.over(half.begin_s, half.end_s)};
    const float common_c = mean_of(half.temp_c);
    for (float& temp_c : placed.temp_c) temp_c -= common_c;
    if (rows_ == RowOrder::at_once) continue;
    const double middle_deg = path.until(placed.turn.mean_s).turned_deg;
    for (std::size_t row = 0; row < frame_rows; ++row) {
      placed.later_s[row] = lens_->row_delay_periods(rows_, row) * (half.end_s - half.begin_s);
      placed.later_deg[row] = path.until(placed.turn.mean_s + placed.later_s[row]).turned_deg - middle_deg;
    }
  }
}

/// What a pixel shows on average beyond its neighbours is its own error; one that is far beyond is broken.
/// Otherwise the mosaic is sharpest where nothing seems to move.
void BiasSearch::take_off_pixel_errors() {
  for (const unsigned parity : {0U, 1U}) {
    HalfPixels sum{}, count{};
    for (const Placed& one : placed_) {
      if (one.parity != parity) continue;
      for (std::size_t i = 0; i < half_pixels; ++i) {
        if (std::isnan(one.temp_c[i])) continue;
        sum[i] += one.temp_c[i];
        count[i] += 1.0F;
      }
    }
    const HalfPixels error_c = beyond_neighbours(sum, count);
    for (Placed& one : placed_) {
      if (one.parity != parity) continue;
      for (std::size_t i = 0; i < half_pixels; ++i)
        one.temp_c[i] = std::abs(error_c[i]) > largest_error_c ? unknown_c : one.temp_c[i] - error_c[i];
    }
  }
}

/// Something warm that moves would otherwise make the sharpest mosaic by itself.
void BiasSearch::clip() {
  for (Placed& one : placed_) {
    float sum = 0.0F, count = 1e-6F;
    for (const float temp_c : one.temp_c) {
      if (std::isnan(temp_c)) continue;
      sum += std::abs(temp_c);
      count += 1.0F;
    }
    const float most = std::max(least_clip_c, clip_of_mean * sum / count);
    for (float& temp_c : one.temp_c)
      if (!std::isnan(temp_c)) temp_c = std::clamp(temp_c, -most, most);
  }
}

double BiasSearch::read_dps() const {
  const ExposedTurn &first = placed_.front().turn, &last = placed_.back().turn;
  return (last.mean_deg - first.mean_deg) / (last.mean_s - first.mean_s);
}

BiasSearch::Biases BiasSearch::biases_that_may_be() const {
  const double step_dps = rows_ == RowOrder::at_once ? finest_step_dps : coarse_step_dps;
  constexpr double reach_dps = 0.5 * (most_steps - 1) * finest_step_dps;
  const auto steps = static_cast<std::size_t>(reach_dps / step_dps);
  return {priors_.bias_dps - reach_dps, step_dps, 2 * steps + 1};
}

BiasSearch::Curve BiasSearch::measure(const HalfStore& store, const GyroPath& path, RowOrder rows,
                                      bool things_move) {
  rows_ = rows;
  place(store, path);
  if (things_move) clip();
  take_off_pixel_errors();
  note_readings();
  const Biases biases = biases_that_may_be();
  std::fill(mosaics_.begin(), mosaics_.end(), Mosaic());
  if (rows == RowOrder::at_once) {
    for (std::size_t i = 0; i < biases.count; ++i) mosaics_[i] = mosaic_with(biases.dps(i));
  } else {
    // One row after the other for all biases: what a row of all halves reads is little memory.
    for (std::size_t row = 0; row < frame_rows; ++row) add_row(row, biases);
  }
  for (std::size_t i = 0; i < biases.count; ++i) variances_[i] = variance(mosaics_[i]);
  const auto end = variances_.begin() + static_cast<std::ptrdiff_t>(biases.count);
  const double least = *std::min_element(variances_.begin(), end);
  ordered_.assign(variances_.begin(), end);
  const auto middle = ordered_.begin() + static_cast<std::ptrdiff_t>(biases.count / 2);
  std::nth_element(ordered_.begin(), middle, ordered_.end());
  const double looked_at = rows == RowOrder::at_once ? 1.0 : 0.5;  // of the pixels
  const bool is_careful = lens_->knows_rows() || things_move;
  const double trusted = is_careful ? trusted_with_care : trusted_of_mosaic;
  return {.variances = {variances_.data(), biases.count},
          .step_dps = biases.step_dps,
          .read_dps = read_dps(),
          .least = least,
          .readings = 0.5 * looked_at * static_cast<double>(halves * half_pixels),
          .trusted = trusted,
          .is_distinct = least <= distinct_share * *middle};
}

std::optional<BiasSearch::Found> BiasSearch::search(const HalfStore& store, const GyroPath& path,
                                                    RowOrder rows, bool things_move) {
  if (store.count() < halves) return std::nullopt;
  return named(measure(store, path, rows, things_move));
}

std::optional<BiasSearch::Found> BiasSearch::named(const Curve& curve) const {
  if (!curve.is_distinct) return std::nullopt;
  const double middle = 0.5 * (static_cast<double>(curve.variances.size()) - 1.0);
  double sum = 0.0, mean = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < curve.variances.size(); ++i) {
    const double off_dps = (static_cast<double>(i) - middle) * curve.step_dps;
    const double weight = curve.likelihood(i, curve.trusted) * bias_before(off_dps, priors_);
    sum += weight;
    mean += weight * off_dps;
    squares += weight * off_dps * off_dps;
  }
  mean /= sum;
  const double sigma_dps = std::sqrt(squares / sum - mean * mean + curve.step_dps * curve.step_dps / 12.0);
  if (sigma_dps > known_well_dps) return std::nullopt;
  return Found{priors_.bias_dps + mean, sigma_dps};
}

}  // namespace thermorig::odometer
