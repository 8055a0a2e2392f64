// SPDX-License-Identifier: MIT
#include "panorama.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thermorig::odometer {

namespace {

constexpr std::size_t map_values = Panorama::bins * frame_rows;
constexpr float seen_enough = 0.98F;         // of what a pixel sweeps
constexpr float least_bin_variance = 1e-3F;  // of a bin: surroundings change

}  // namespace

Panorama::Panorama()
    : temp_c_(map_values),
      variance_(map_values),
      seen_(map_values),
      temp_sum_(map_values + frame_rows),
      variance_sum_(map_values + frame_rows),
      seen_sum_(map_values + frame_rows) {}

void Panorama::clear() {
  std::fill(temp_c_.begin(), temp_c_.end(), 0.0F);
  std::fill(variance_.begin(), variance_.end(), 0.0F);
  std::fill(seen_.begin(), seen_.end(), 0.0F);
  add_up();
}

Panorama::Place Panorama::place(double azimuth_deg, double half_width_deg, std::size_t row_class) {
  const double turns = azimuth_deg / whole_turn_deg;
  const double middle = (turns - std::floor(turns)) * static_cast<double>(bins);
  return {middle, std::clamp(half_width_deg / bin_deg, 0.5, 0.25 * static_cast<double>(bins)), row_class};
}

void Panorama::add_up(const std::vector<float>& of_bins, Sums& sums) const {
  for (std::size_t bin = 0; bin < bins; ++bin)
    for (std::size_t i = 0; i < frame_rows; ++i)
      sums[(bin + 1) * frame_rows + i] = sums[bin * frame_rows + i] + of_bins[bin * frame_rows + i];
}

void Panorama::add_up() {
  add_up(temp_c_, temp_sum_);
  add_up(variance_, variance_sum_);
  add_up(seen_, seen_sum_);
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
  add_up();
}

/// Over the bins from the origin on; a position beyond either end counts whole turns.
void Panorama::sum_until(const Sums& sums, double position, std::size_t row_class, Column& sum) const {
  const double whole = std::floor(position);
  const auto part = static_cast<float>(position - whole);
  auto bin = static_cast<std::ptrdiff_t>(whole);
  constexpr auto all = static_cast<std::ptrdiff_t>(bins);
  float turns = 0.0F;
  for (; bin < 0; bin += all) turns -= 1.0F;
  for (; bin >= all; bin -= all) turns += 1.0F;
  const float* before = &sums[index(static_cast<std::size_t>(bin), row_class)];
  const float* behind = before + frame_rows;
  const float* total = &sums[index(bins, row_class)];
  for (std::size_t k = 0; k < half_rows; ++k)
    sum[k] = before[k] + part * (behind[k] - before[k]) + turns * total[k];
}

void Panorama::sum_between(const Sums& sums, double from, double to, std::size_t row_class,
                           Column& sum) const {
  Column before;
  sum_until(sums, from, row_class, before);
  sum_until(sums, to, row_class, sum);
  for (std::size_t k = 0; k < half_rows; ++k) sum[k] -= before[k];
}

/// The mean changes by what comes in at one end of the sweep and goes out at the other.
void Panorama::look_slope(const Place& place, double reach, Look& look) const {
  const double low = place.middle - place.half_width, high = place.middle + place.half_width;
  Column in, out, in_variance, out_variance;
  sum_between(temp_sum_, high - reach, high + reach, place.row_class, in);
  sum_between(temp_sum_, low - reach, low + reach, place.row_class, out);
  sum_between(variance_sum_, high - reach, high + reach, place.row_class, in_variance);
  sum_between(variance_sum_, low - reach, low + reach, place.row_class, out_variance);
  const auto scale = static_cast<float>(1.0 / (2.0 * place.half_width * 2.0 * reach * bin_deg));
  for (std::size_t k = 0; k < half_rows; ++k) {
    look.slope[k] = scale * (in[k] - out[k]);
    look.slope_variance[k] = scale * scale * (in_variance[k] + out_variance[k]);
  }
}

void Panorama::look(const Place& place, double reach, bool smooth, Look& look) const {
  const double low = place.middle - place.half_width, high = place.middle + place.half_width;
  const auto width = static_cast<float>(2.0 * place.half_width);
  const auto wide = static_cast<float>(2.0 * (place.half_width + reach));
  Column seen;
  sum_between(temp_sum_, low, high, place.row_class, look.temp_c);
  sum_between(variance_sum_, low, high, place.row_class, look.variance);
  sum_between(seen_sum_, low - reach, high + reach, place.row_class, seen);
  for (std::size_t k = 0; k < half_rows; ++k) {
    look.temp_c[k] /= width;
    look.variance[k] /= width * width;
    look.known[k] = seen[k] >= seen_enough * wide ? 1.0F : 0.0F;
  }
  look_slope(place, reach, look);
  if (!smooth) return;
  Place other = place;
  other.row_class ^= 1U;
  Look beside;
  look_slope(other, reach, beside);
  for (std::size_t k = 0; k < half_rows; ++k) {
    // Rows above and below: of row 2k those are k - 1 and k of the odd ones, of row 2k + 1 k and k + 1 of the
    // even ones.
    const std::size_t above = place.row_class == 0 ? (k > 0 ? k - 1 : 0) : k;
    const std::size_t below = place.row_class == 0 ? k : std::min(k + 1, half_rows - 1);
    look.slope[k] = 0.5F * look.slope[k] + 0.25F * (beside.slope[above] + beside.slope[below]);
    look.slope_variance[k] = 0.25F * look.slope_variance[k] +
                             0.0625F * (beside.slope_variance[above] + beside.slope_variance[below]);
  }
}

void Panorama::look(const Place& place, Column& temp_c, Column& known) const {
  const double low = place.middle - place.half_width, high = place.middle + place.half_width;
  const auto width = static_cast<float>(2.0 * place.half_width);
  sum_between(temp_sum_, low, high, place.row_class, temp_c);
  sum_between(seen_sum_, low, high, place.row_class, known);
  for (std::size_t k = 0; k < half_rows; ++k) {
    temp_c[k] /= width;
    known[k] = known[k] >= seen_enough * width ? 1.0F : 0.0F;
  }
}

void Panorama::seed(const Place& place, const Guess& guess) {
  const auto from = static_cast<std::ptrdiff_t>(std::floor(guess.low));
  const auto to = static_cast<std::ptrdiff_t>(std::floor(guess.high));
  constexpr auto all = static_cast<std::ptrdiff_t>(bins);
  for (std::ptrdiff_t bin = from; bin <= to; ++bin) {
    const std::size_t first = index(static_cast<std::size_t>((bin % all + all) % all), place.row_class);
    const auto off_deg = static_cast<float>((static_cast<double>(bin) + 0.5 - place.middle) * bin_deg);
    for (std::size_t k = 0; k < half_rows; ++k) {
      if (seen_[first + k] > 0.0F || std::isnan(guess.temp_c[k])) continue;
      seen_[first + k] = 1.0F;
      temp_c_[first + k] = guess.temp_c[k] + guess.slope[k] * off_deg;
      variance_[first + k] = guess.variance[k];
    }
  }
}

void Panorama::write(const Place& place, const Column& temp_c, const Column& variance) {
  const double low = place.middle - place.half_width, high = place.middle + place.half_width;
  const auto from = static_cast<std::ptrdiff_t>(std::floor(low));
  const auto to = static_cast<std::ptrdiff_t>(std::floor(high));
  constexpr auto all = static_cast<std::ptrdiff_t>(bins);
  const auto share_of = [&](std::ptrdiff_t bin) {
    const auto begin = static_cast<double>(bin);
    return static_cast<float>((std::min(high, begin + 1.0) - std::max(low, begin)) / (high - low));
  };
  const auto first_of = [&](std::ptrdiff_t bin) {
    return index(static_cast<std::size_t>((bin % all + all) % all), place.row_class);
  };
  Column mean{}, spread{};
  for (std::ptrdiff_t bin = from; bin <= to; ++bin) {
    const float share = share_of(bin);
    const float *temp = &temp_c_[first_of(bin)], *of_bin = &variance_[first_of(bin)];
    for (std::size_t k = 0; k < half_rows; ++k) {
      mean[k] += share * temp[k];
      spread[k] += share * share * of_bin[k];
    }
  }
  Column innovation, scale;
  for (std::size_t k = 0; k < half_rows; ++k) {
    const bool is_read = !std::isnan(temp_c[k]);
    innovation[k] = is_read ? temp_c[k] - mean[k] : 0.0F;
    scale[k] = is_read ? 1.0F / (spread[k] + variance[k]) : 0.0F;
  }
  for (std::ptrdiff_t bin = from; bin <= to; ++bin) {
    const float share = share_of(bin);
    float *temp = &temp_c_[first_of(bin)], *of_bin = &variance_[first_of(bin)];
    for (std::size_t k = 0; k < half_rows; ++k) {
      const float gain = share * of_bin[k] * scale[k];
      temp[k] += gain * innovation[k];
      of_bin[k] = std::max(least_bin_variance, of_bin[k] * (1.0F - gain * share));
    }
  }
}

}  // namespace thermorig::odometer
