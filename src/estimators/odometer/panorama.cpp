// SPDX-License-Identifier: MIT
#include "panorama.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thermorig::odometer {

namespace {

constexpr std::size_t map_values = Panorama::bins * frame_rows;
constexpr float seen_enough = 0.98F;      // of what a pixel sweeps
constexpr float strange_squares = 16.0F;  // of a reading, in units of its variance: it may be what moves
constexpr float widening = 0.5F, most_widened = 4.0F;  // of a bin's variance, a strange reading; K^2
constexpr float least_bin_variance = 1e-3F;            // of a bin: surroundings change

/// From what comes into a mean less what goes out of it, moved by `reach` to both sides, to its slope.
float slope_scale(const Panorama::Place& place, std::ptrdiff_t reach) {
  return static_cast<float>(1.0 /
                            (2.0 * place.half_width * 2.0 * static_cast<double>(reach) * Panorama::bin_deg));
}

/// In the other class of rows: of row 2k those are k - 1 and k of the odd ones, of row 2k + 1 k and k + 1 of
/// the even ones.
std::size_t above_in_other(std::size_t other, std::size_t k) {
  return other == 1 ? (k > 0 ? k - 1 : 0) : k;
}

std::size_t below_in_other(std::size_t other, std::size_t k) {
  return other == 1 ? k : std::min(k + 1, half_rows - 1);
}

}  // namespace

Panorama::Panorama()
    : temp_c_(map_values),
      variance_(map_values),
      seen_(map_values),
      temp_sum_(map_values + frame_rows),
      variance_sum_(map_values + frame_rows),
      seen_sum_(map_values + frame_rows) {}

void Panorama::clear(bool rows_look_apart, bool things_move) {
  rows_look_apart_ = rows_look_apart;
  things_move_ = things_move;
  std::fill(temp_c_.begin(), temp_c_.end(), 0.0F);
  std::fill(variance_.begin(), variance_.end(), 0.0F);
  std::fill(seen_.begin(), seen_.end(), 0.0F);
  changed_from_ = 0;
  add_up();
}

void Panorama::add_up(const std::vector<float>& of_bins, Sums& sums) const {
  for (std::size_t bin = changed_from_; bin < bins; ++bin)
    for (std::size_t i = 0; i < frame_rows; ++i)
      sums[(bin + 1) * frame_rows + i] = sums[bin * frame_rows + i] + of_bins[bin * frame_rows + i];
}

void Panorama::add_up() {
  if (rows_look_apart_) {
    row_sums_.add_up(temp_c_, variance_, seen_, changed_from_);
  } else {
    add_up(temp_c_, temp_sum_);
    add_up(variance_, variance_sum_);
    add_up(seen_, seen_sum_);
  }
  changed_from_ = bins;
}

/// In bins from the first to the last; all of the map, if they reach beyond its ends.
void Panorama::note_change(std::ptrdiff_t from, std::ptrdiff_t to) {
  const bool is_beyond = from < 0 || to >= static_cast<std::ptrdiff_t>(bins);
  changed_from_ = is_beyond ? 0 : std::min(changed_from_, static_cast<std::size_t>(from));
}

std::vector<float> Panorama::image() const {
  std::vector<float> pixels(map_values, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t row = 0; row < frame_rows; ++row)
    for (std::size_t bin = 0; bin < bins; ++bin) {
      const std::size_t from = index(bin, row % 2) + row / 2;
      if (seen_[from] > 0.0F) pixels[row * bins + bin] = temp_c_[from];
    }
  return pixels;
}

void Panorama::keep(Map& map) const {
  map.temp_k = temp_c_;
  map.variance_k2 = variance_;
  std::transform(seen_.begin(), seen_.end(), map.seen.begin(),
                 [](float seen) { return static_cast<std::uint8_t>(seen > 0.0F); });
}

void Panorama::load(const Map& map) {
  std::copy(map.temp_k.begin(), map.temp_k.end(), temp_c_.begin());
  std::copy(map.variance_k2.begin(), map.variance_k2.end(), variance_.begin());
  std::copy(map.seen.begin(), map.seen.end(), seen_.begin());
  changed_from_ = 0;
  add_up();
}

void Panorama::sum_between(const Sums& sums, const BinPosition& from, const BinPosition& to,
                           std::size_t row_class, Column& sum) {
  const float* total = &sums[index(bins, row_class)];
  const auto until = [&](const BinPosition& at, std::size_t k) {
    const float* before = &sums[index(at.bin, row_class)];
    const float* behind = before + frame_rows;
    return before[k] + at.part * (behind[k] - before[k]) + at.turns * total[k];
  };
  for (std::size_t k = 0; k < half_rows; ++k) sum[k] = until(to, k) - until(from, k);
}

/// The mean changes by what comes in at one end of the sweep and goes out at the other.
void Panorama::look_slope(const Place& place, const SweepEnds& ends, std::size_t row_class,
                          std::ptrdiff_t reach, Slopes& slopes) const {
  Column in, out, in_variance, out_variance;
  sum_between(temp_sum_, ends.before_high, ends.after_high, row_class, in);
  sum_between(temp_sum_, ends.before_low, ends.after_low, row_class, out);
  sum_between(variance_sum_, ends.before_high, ends.after_high, row_class, in_variance);
  sum_between(variance_sum_, ends.before_low, ends.after_low, row_class, out_variance);
  const float scale = slope_scale(place, reach);
  for (std::size_t k = 0; k < half_rows; ++k) {
    slopes.slope[k] = scale * (in[k] - out[k]);
    slopes.variance[k] = scale * scale * (in_variance[k] + out_variance[k]);
  }
}

void Panorama::look_at_mean(const Place& place, const SweepEnds& at, std::ptrdiff_t reach, Look& look) const {
  const auto width = static_cast<float>(2.0 * place.half_width);
  const auto wide = static_cast<float>(2.0 * (place.half_width + static_cast<double>(reach)));
  Column seen;
  sum_between(temp_sum_, at.low, at.high, place.row_class, look.temp_c);
  sum_between(variance_sum_, at.low, at.high, place.row_class, look.variance);
  sum_between(seen_sum_, at.before_low, at.after_high, place.row_class, seen);
  for (std::size_t k = 0; k < half_rows; ++k) {
    look.temp_c[k] /= width;
    look.variance[k] /= width * width;
    look.known[k] = seen[k] >= seen_enough * wide ? 1.0F : 0.0F;
  }
}

void Panorama::look(const Place& place, std::ptrdiff_t reach, bool smooth, Look& look) const {
  const SweepEnds at = ends(place, reach);
  look_at_mean(place, at, reach, look);
  look_slope(place, at, place.row_class, reach, look.of_azimuth);
  if (!smooth) return;
  const std::size_t other = place.row_class ^ 1U;
  Slopes beside;
  look_slope(place, at, other, reach, beside);
  for (std::size_t k = 0; k < half_rows; ++k) {
    float &slope = look.of_azimuth.slope[k], &variance = look.of_azimuth.variance[k];
    const std::size_t above = above_in_other(other, k), below = below_in_other(other, k);
    slope = 0.5F * slope + 0.25F * (beside.slope[above] + beside.slope[below]);
    variance = 0.25F * variance + 0.0625F * (beside.variance[above] + beside.variance[below]);
  }
}

void Panorama::look_at_mean(const Place& place, std::ptrdiff_t reach, Look& look) const {
  look_at_mean(place, ends(place, reach), reach, look);
}

void Panorama::look(const Place& place, Column& temp_c, Column& known) const {
  const SweepEnds at = ends(place, 0);
  const auto width = static_cast<float>(2.0 * place.half_width);
  sum_between(temp_sum_, at.low, at.high, place.row_class, temp_c);
  sum_between(seen_sum_, at.low, at.high, place.row_class, known);
  for (std::size_t k = 0; k < half_rows; ++k) {
    temp_c[k] /= width;
    known[k] = known[k] >= seen_enough * width ? 1.0F : 0.0F;
  }
}

Panorama::Slope Panorama::slope_of_row(std::size_t row, const SweepEnds& ends, float scale) const {
  const RowSums::Sum in = row_sums_.between(row, ends.before_high, ends.after_high);
  const RowSums::Sum out = row_sums_.between(row, ends.before_low, ends.after_low);
  return {scale * (in - out)[RowSums::temp_c], scale * scale * (in + out)[RowSums::variance]};
}

void Panorama::look_at_mean_row(const Place& place, const SweepEnds& at, std::size_t k, std::ptrdiff_t reach,
                                Look& look) const {
  const auto wide = static_cast<float>(2.0 * (place.half_width + static_cast<double>(reach)));
  const float share = 1.0F / static_cast<float>(2.0 * place.half_width);  // of a bin
  const std::size_t row = index(0, place.row_class) + k;
  const RowSums::Sum swept = row_sums_.between(row, at.low, at.high);
  const RowSums::Sum around = row_sums_.between(row, at.before_low, at.after_high);
  look.temp_c[k] = share * swept[RowSums::temp_c];
  look.variance[k] = share * share * swept[RowSums::variance];
  look.known[k] = around[RowSums::seen] >= seen_enough * wide ? 1.0F : 0.0F;
}

void Panorama::look_row(const Place& place, std::size_t k, std::ptrdiff_t reach, bool smooth,
                        Look& look) const {
  const SweepEnds at = ends(place, reach);
  look_at_mean_row(place, at, k, reach, look);
  const float scale = slope_scale(place, reach);
  const Slope own = slope_of_row(index(0, place.row_class) + k, at, scale);
  float &slope = look.of_azimuth.slope[k], &variance = look.of_azimuth.variance[k];
  slope = own.slope;
  variance = own.variance;
  if (!smooth) return;
  const std::size_t other = place.row_class ^ 1U;
  const Slope above = slope_of_row(index(0, other) + above_in_other(other, k), at, scale);
  const Slope below = slope_of_row(index(0, other) + below_in_other(other, k), at, scale);
  slope = 0.5F * slope + 0.25F * (above.slope + below.slope);
  variance = 0.25F * variance + 0.0625F * (above.variance + below.variance);
}

void Panorama::look_at_mean_row(const Place& place, std::size_t k, std::ptrdiff_t reach, Look& look) const {
  look_at_mean_row(place, ends(place, reach), k, reach, look);
}

void Panorama::look_row(const Place& place, std::size_t k, Column& temp_c, Column& known) const {
  const std::size_t row = index(0, place.row_class) + k;
  const auto width = static_cast<float>(2.0 * place.half_width);
  const SweepEnds at = ends(place, 0);
  const RowSums::Sum swept = row_sums_.between(row, at.low, at.high);
  temp_c[k] = swept[RowSums::temp_c] / width;
  known[k] = swept[RowSums::seen] >= seen_enough * width ? 1.0F : 0.0F;
}

template <std::size_t pixels>
void Panorama::seed_pixels(const Place& place, std::size_t first_k, const Guess& guess) {
  const auto from = static_cast<std::ptrdiff_t>(std::floor(guess.low));
  const auto to = static_cast<std::ptrdiff_t>(std::floor(guess.high));
  constexpr auto all = static_cast<std::ptrdiff_t>(bins);
  note_change(from, to);
  for (std::ptrdiff_t bin = from; bin <= to; ++bin) {
    const std::size_t first = index(static_cast<std::size_t>((bin % all + all) % all), place.row_class);
    const auto off_deg = static_cast<float>((static_cast<double>(bin) + 0.5 - place.middle) * bin_deg);
    for (std::size_t k = first_k; k < first_k + pixels; ++k) {
      if (seen_[first + k] > 0.0F || std::isnan(guess.temp_c[k])) continue;
      seen_[first + k] = 1.0F;
      temp_c_[first + k] = guess.temp_c[k] + guess.slope[k] * off_deg;
      variance_[first + k] = guess.variance[k];
    }
  }
}

void Panorama::seed(const Place& place, const Guess& guess) {
  seed_pixels<half_rows>(place, 0, guess);
}

void Panorama::seed_row(const Place& place, std::size_t k, const Guess& guess) {
  seed_pixels<1>(place, k, guess);
}

template <std::size_t pixels>
void Panorama::write_pixels(const Place& place, std::size_t first, const Column& temp_c,
                            const Column& variance) {
  const double low = place.middle - place.half_width, high = place.middle + place.half_width;
  const auto from = static_cast<std::ptrdiff_t>(std::floor(low));
  const auto to = static_cast<std::ptrdiff_t>(std::floor(high));
  note_change(from, to);
  const double share_of_bin = 1.0 / (high - low);
  const std::size_t end = first + pixels;
  const auto share_of = [&](std::ptrdiff_t bin) {
    const auto begin = static_cast<double>(bin);
    return static_cast<float>((std::min(high, begin + 1.0) - std::max(low, begin)) * share_of_bin);
  };
  const auto first_of = [&](std::ptrdiff_t bin) {
    return index(bin_position(bin, 0.0F).bin, place.row_class);
  };
  Column mean, spread;
  for (std::size_t k = first; k < end; ++k) mean[k] = spread[k] = 0.0F;
  for (std::ptrdiff_t bin = from; bin <= to; ++bin) {
    const float share = share_of(bin);
    const float *temp = &temp_c_[first_of(bin)], *of_bin = &variance_[first_of(bin)];
    for (std::size_t k = first; k < end; ++k) {
      mean[k] += share * temp[k];
      spread[k] += share * share * of_bin[k];
    }
  }
  Column innovation, scale, widened;
  for (std::size_t k = first; k < end; ++k) {
    const bool is_read = !std::isnan(temp_c[k]);
    innovation[k] = is_read ? temp_c[k] - mean[k] : 0.0F;
    scale[k] = is_read ? 1.0F / (spread[k] + variance[k]) : 0.0F;
    widened[k] = 1.0F;
    const float squares = innovation[k] * innovation[k] * scale[k];
    if (!things_move_ || squares <= strange_squares) continue;
    const float trust = 1.0F / ((1.0F + squares / 9.0F) * (1.0F + squares / 9.0F));
    scale[k] = 1.0F / (spread[k] + variance[k] / trust);
    widened[k] += widening * (1.0F - trust);  // what stays is believed after some halves
  }
  for (std::ptrdiff_t bin = from; bin <= to; ++bin) {
    const float share = share_of(bin);
    float *temp = &temp_c_[first_of(bin)], *of_bin = &variance_[first_of(bin)];
    for (std::size_t k = first; k < end; ++k) {
      const float gain = share * of_bin[k] * scale[k];
      temp[k] += gain * innovation[k];
      of_bin[k] = std::max(least_bin_variance, of_bin[k] * (1.0F - gain * share));
      if (widened[k] > 1.0F) of_bin[k] = std::max(of_bin[k], std::min(most_widened, of_bin[k] * widened[k]));
    }
  }
}

void Panorama::write(const Place& place, const Column& temp_c, const Column& variance) {
  write_pixels<half_rows>(place, 0, temp_c, variance);
}

void Panorama::write_row(const Place& place, std::size_t k, const Column& temp_c, const Column& variance) {
  write_pixels<1>(place, k, temp_c, variance);
}

}  // namespace thermorig::odometer
