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

}  // namespace

Panorama::Panorama()
    : temp_c_(map_values),
      variance_(map_values),
      seen_(map_values),
      temp_sum_(map_values + frame_rows),
      variance_sum_(map_values + frame_rows),
      seen_sum_(map_values + frame_rows) {}

void Panorama::clear(bool things_move) {
  things_move_ = things_move;
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

/// A position beyond either end counts a whole turn; none is further away than one.
Panorama::Position Panorama::position(std::ptrdiff_t bin, float part) {
  constexpr auto all = static_cast<std::ptrdiff_t>(bins);
  if (bin < 0) return {static_cast<std::size_t>(bin + all), part, -1.0F};
  if (bin >= all) return {static_cast<std::size_t>(bin - all), part, 1.0F};
  return {static_cast<std::size_t>(bin), part, 0.0F};
}

Panorama::Position Panorama::position(double at) {
  const double whole = std::floor(at);
  return position(static_cast<std::ptrdiff_t>(whole), static_cast<float>(at - whole));
}

Panorama::Ends Panorama::ends(const Place& place, std::ptrdiff_t reach) {
  const auto about = [&](double at, Position& before, Position& here, Position& after) {
    const double whole = std::floor(at);
    const auto bin = static_cast<std::ptrdiff_t>(whole);
    const auto part = static_cast<float>(at - whole);
    before = position(bin - reach, part);
    here = position(bin, part);
    after = position(bin + reach, part);
  };
  Ends ends;
  about(place.middle - place.half_width, ends.before_low, ends.low, ends.after_low);
  about(place.middle + place.half_width, ends.before_high, ends.high, ends.after_high);
  return ends;
}

template <std::size_t pixels>
void Panorama::sum_between(const Sums& sums, const Position& from, const Position& to, std::size_t row_class,
                           std::size_t first, Column& sum) {
  const float* total = &sums[index(bins, row_class)];
  const auto until = [&](const Position& at, std::size_t k) {
    const float* before = &sums[index(at.bin, row_class)];
    const float* behind = before + frame_rows;
    return before[k] + at.part * (behind[k] - before[k]) + at.turns * total[k];
  };
  for (std::size_t k = first; k < first + pixels; ++k) sum[k] = until(to, k) - until(from, k);
}

/// The mean changes by what comes in at one end of the sweep and goes out at the other.
template <std::size_t pixels>
void Panorama::look_slope(const Place& place, const Ends& ends, std::size_t row_class, std::size_t first,
                          std::ptrdiff_t reach, Slopes& slopes) const {
  Column in, out, in_variance, out_variance;
  sum_between<pixels>(temp_sum_, ends.before_high, ends.after_high, row_class, first, in);
  sum_between<pixels>(temp_sum_, ends.before_low, ends.after_low, row_class, first, out);
  sum_between<pixels>(variance_sum_, ends.before_high, ends.after_high, row_class, first, in_variance);
  sum_between<pixels>(variance_sum_, ends.before_low, ends.after_low, row_class, first, out_variance);
  const auto scale =
      static_cast<float>(1.0 / (2.0 * place.half_width * 2.0 * static_cast<double>(reach) * bin_deg));
  for (std::size_t k = first; k < first + pixels; ++k) {
    slopes.slope[k] = scale * (in[k] - out[k]);
    slopes.variance[k] = scale * scale * (in_variance[k] + out_variance[k]);
  }
}

template <std::size_t pixels>
void Panorama::look_at_mean(const Place& place, const Ends& at, std::size_t first, std::ptrdiff_t reach,
                            Look& look) const {
  const auto width = static_cast<float>(2.0 * place.half_width);
  const auto wide = static_cast<float>(2.0 * (place.half_width + static_cast<double>(reach)));
  Column seen;
  sum_between<pixels>(temp_sum_, at.low, at.high, place.row_class, first, look.temp_c);
  sum_between<pixels>(variance_sum_, at.low, at.high, place.row_class, first, look.variance);
  sum_between<pixels>(seen_sum_, at.before_low, at.after_high, place.row_class, first, seen);
  for (std::size_t k = first; k < first + pixels; ++k) {
    look.temp_c[k] /= width;
    look.variance[k] /= width * width;
    look.known[k] = seen[k] >= seen_enough * wide ? 1.0F : 0.0F;
  }
}

template <std::size_t pixels>
void Panorama::look_pixels(const Place& place, std::size_t first, std::ptrdiff_t reach, bool smooth,
                           Look& look) const {
  const Ends at = ends(place, reach);
  look_at_mean<pixels>(place, at, first, reach, look);
  look_slope<pixels>(place, at, place.row_class, first, reach, look.of_azimuth);
  if (!smooth) return;
  // Rows above and below: of row 2k those are k - 1 and k of the odd ones, of row 2k + 1 k and k + 1 of the
  // even ones.
  const std::size_t other = place.row_class ^ 1U;
  const auto above = [&](std::size_t k) { return other == 1 ? (k > 0 ? k - 1 : 0) : k; };
  const auto below = [&](std::size_t k) { return other == 1 ? k : std::min(k + 1, half_rows - 1); };
  Slopes beside;
  look_slope<pixels>(place, at, other, pixels == 1 ? above(first) : first, reach, beside);
  if (pixels == 1) look_slope<pixels>(place, at, other, below(first), reach, beside);
  for (std::size_t k = first; k < first + pixels; ++k) {
    float &slope = look.of_azimuth.slope[k], &variance = look.of_azimuth.variance[k];
    slope = 0.5F * slope + 0.25F * (beside.slope[above(k)] + beside.slope[below(k)]);
    variance = 0.25F * variance + 0.0625F * (beside.variance[above(k)] + beside.variance[below(k)]);
  }
}

void Panorama::look(const Place& place, std::ptrdiff_t reach, bool smooth, Look& look) const {
  look_pixels<half_rows>(place, 0, reach, smooth, look);
}

void Panorama::look_row(const Place& place, std::size_t k, std::ptrdiff_t reach, bool smooth,
                        Look& look) const {
  look_pixels<1>(place, k, reach, smooth, look);
}

void Panorama::look_at_mean(const Place& place, std::ptrdiff_t reach, Look& look) const {
  look_at_mean<half_rows>(place, ends(place, reach), 0, reach, look);
}

void Panorama::look_at_mean_row(const Place& place, std::size_t k, std::ptrdiff_t reach, Look& look) const {
  look_at_mean<1>(place, ends(place, reach), k, reach, look);
}

template <std::size_t pixels>
void Panorama::look_pixels(const Place& place, std::size_t first, Column& temp_c, Column& known) const {
  const Position low = position(place.middle - place.half_width);
  const Position high = position(place.middle + place.half_width);
  const auto width = static_cast<float>(2.0 * place.half_width);
  sum_between<pixels>(temp_sum_, low, high, place.row_class, first, temp_c);
  sum_between<pixels>(seen_sum_, low, high, place.row_class, first, known);
  for (std::size_t k = first; k < first + pixels; ++k) {
    temp_c[k] /= width;
    known[k] = known[k] >= seen_enough * width ? 1.0F : 0.0F;
  }
}

void Panorama::look(const Place& place, Column& temp_c, Column& known) const {
  look_pixels<half_rows>(place, 0, temp_c, known);
}

void Panorama::look_row(const Place& place, std::size_t k, Column& temp_c, Column& known) const {
  look_pixels<1>(place, k, temp_c, known);
}

template <std::size_t pixels>
void Panorama::seed_pixels(const Place& place, std::size_t first_k, const Guess& guess) {
  const auto from = static_cast<std::ptrdiff_t>(std::floor(guess.low));
  const auto to = static_cast<std::ptrdiff_t>(std::floor(guess.high));
  constexpr auto all = static_cast<std::ptrdiff_t>(bins);
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
  const std::size_t end = first + pixels;
  const auto share_of = [&](std::ptrdiff_t bin) {
    const auto begin = static_cast<double>(bin);
    return static_cast<float>((std::min(high, begin + 1.0) - std::max(low, begin)) / (high - low));
  };
  const auto first_of = [&](std::ptrdiff_t bin) { return index(position(bin, 0.0F).bin, place.row_class); };
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
