// SPDX-License-Identifier: MIT
#include "panorama.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thermorig::odometer {

namespace {

constexpr std::size_t map_values = Panorama::bins * frame_rows;
constexpr float seen_enough = 0.98F;  // of what a pixel sweeps
constexpr float outlier_nis = 16.0F;  // of a reading, in units of its variance: it may be what moves
constexpr float widening = 0.5F, most_widened = 4.0F;  // of a bin's variance, an outlier; K^2
constexpr float least_bin_variance = 1e-3F;            // of a bin: surroundings change

/// From what comes into a mean less what goes out of it, moved by `reach` to both sides, to its slope.
float slope_scale(const Panorama::Ray& ray, std::ptrdiff_t reach) {
  return static_cast<float>(1.0 /
                            (2.0 * ray.half_width * 2.0 * static_cast<double>(reach) * Panorama::bin_deg));
}

/// In the other class of rows: of row 2k those are k - 1 and k of the odd ones, of row 2k + 1 k and k + 1 of
/// the even ones.
std::size_t above_in_other(std::size_t other, std::size_t k) {
  return other == 1 ? (k > 0 ? k - 1 : 0) : k;
}

std::size_t below_in_other(std::size_t other, std::size_t k) {
  return other == 1 ? k : std::min(k + 1, half_rows - 1);
}

/// Between two bins of the map.
struct BinPosition {
  std::size_t bin = 0;              // before it
  float part = 0.0F, turns = 0.0F;  // of the way to the next one; whole turns beyond the map's ends
};

/// A bin beyond either end counts a whole turn; none is further away than one.
BinPosition bin_position(std::ptrdiff_t bin, float part) {
  constexpr auto all = static_cast<std::ptrdiff_t>(Panorama::bins);
  if (bin < 0) return {static_cast<std::size_t>(bin + all), part, -1.0F};
  if (bin >= all) return {static_cast<std::size_t>(bin - all), part, 1.0F};
  return {static_cast<std::size_t>(bin), part, 0.0F};
}

/// What lies between two places, of so many pixels from the one on that stands `first` in the first bin.
/// `sums`: of all bins before.
template <std::size_t pixels>
void sum_between(const std::vector<float>& sums, const BinPosition& from, const BinPosition& to,
                 std::size_t first, std::array<float, pixels>& sum) {
  const auto until = [&](const BinPosition& at, std::size_t i) {
    const float* before = &sums[at.bin * frame_rows + first];
    const float* behind = before + frame_rows;
    return before[i] + at.part * (behind[i] - before[i]);
  };
  if (from.turns == 0.0F && to.turns == 0.0F) {
    for (std::size_t i = 0; i < pixels; ++i) sum[i] = until(to, i) - until(from, i);
    return;
  }
  const float* total = &sums[Panorama::bins * frame_rows + first];
  for (std::size_t i = 0; i < pixels; ++i)
    sum[i] = until(to, i) + to.turns * total[i] - (until(from, i) + from.turns * total[i]);
}

}  // namespace

/// What pixels sweep ends there, and so much to either side of both.
struct Panorama::SweepEnds {
  SweepEnds(const Ray& ray, std::ptrdiff_t reach) {
    put(ray.middle - ray.half_width, reach, before_low, low, after_low);
    put(ray.middle + ray.half_width, reach, before_high, high, after_high);
  }

  BinPosition before_low, low, after_low, before_high, high, after_high;

 private:
  static void put(double at, std::ptrdiff_t reach, BinPosition& before, BinPosition& here,
                  BinPosition& after) {
    const auto towards_0 = static_cast<std::ptrdiff_t>(at);
    const std::ptrdiff_t bin = static_cast<double>(towards_0) > at ? towards_0 - 1 : towards_0;
    const auto part = static_cast<float>(at - static_cast<double>(bin));
    before = bin_position(bin - reach, part);
    here = bin_position(bin, part);
    after = bin_position(bin + reach, part);
  }
};

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
  changed_from_ = 0;
  add_up();
}

void Panorama::add_up(const std::vector<float>& of_bins, Sums& sums) const {
  for (std::size_t bin = changed_from_; bin < bins; ++bin)
    for (std::size_t i = 0; i < frame_rows; ++i)
      sums[(bin + 1) * frame_rows + i] = sums[bin * frame_rows + i] + of_bins[bin * frame_rows + i];
}

void Panorama::add_up() {
  add_up(temp_c_, temp_sum_);
  add_up(variance_, variance_sum_);
  add_up(seen_, seen_sum_);
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

/// The mean changes by what comes in at one end of the sweep and goes out at the other.
template <std::size_t pixels>
void Panorama::find_slopes(const SweepEnds& at, std::size_t first, float scale, float* slope,
                           float* variance) const {
  Pixels<pixels> in, out, in_variance, out_variance;
  sum_between(temp_sum_, at.before_high, at.after_high, first, in);
  sum_between(temp_sum_, at.before_low, at.after_low, first, out);
  sum_between(variance_sum_, at.before_high, at.after_high, first, in_variance);
  sum_between(variance_sum_, at.before_low, at.after_low, first, out_variance);
  for (std::size_t i = 0; i < pixels; ++i) {
    slope[i] = scale * (in[i] - out[i]);
    variance[i] = scale * scale * (in_variance[i] + out_variance[i]);
  }
}

template <std::size_t pixels>
void Panorama::predict_mean(const Ray& ray, const SweepEnds& at, std::ptrdiff_t reach,
                            Predicted& predicted) const {
  const auto width = static_cast<float>(2.0 * ray.half_width);
  const auto wide = static_cast<float>(2.0 * (ray.half_width + static_cast<double>(reach)));
  const std::size_t first = index(0, ray.row_class) + ray.k;
  Pixels<pixels> temp_c, variance, seen;
  sum_between(temp_sum_, at.low, at.high, first, temp_c);
  sum_between(variance_sum_, at.low, at.high, first, variance);
  sum_between(seen_sum_, at.before_low, at.after_high, first, seen);
  const float share = 1.0F / width;  // one pixel waits for a division longer than for all else here
  for (std::size_t i = 0; i < pixels; ++i) {
    predicted.temp_c[ray.k + i] = pixels == 1 ? share * temp_c[i] : temp_c[i] / width;
    predicted.variance[ray.k + i] = pixels == 1 ? share * share * variance[i] : variance[i] / (width * width);
    predicted.known[ray.k + i] = seen[i] >= seen_enough * wide ? 1.0F : 0.0F;
  }
}

template <std::size_t pixels>
void Panorama::predict_of(const Ray& ray, std::ptrdiff_t reach, bool smooth, Predicted& predicted) const {
  const SweepEnds at(ray, reach);
  predict_mean<pixels>(ray, at, reach, predicted);
  const float scale = slope_scale(ray, reach);
  float *const slope = &predicted.of_azimuth.slope[ray.k], *const variance =
                                                               &predicted.of_azimuth.variance[ray.k];
  find_slopes<pixels>(at, index(0, ray.row_class) + ray.k, scale, slope, variance);
  if (!smooth) return;
  constexpr std::size_t around = std::min(pixels + 1, half_rows);  // of the other class
  const std::size_t other = ray.row_class ^ 1U;
  const std::size_t from = std::min(above_in_other(other, ray.k), half_rows - around);
  Pixels<around> beside, beside_variance;
  find_slopes<around>(at, index(0, other) + from, scale, beside.data(), beside_variance.data());
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::size_t above = above_in_other(other, ray.k + i) - from;
    const std::size_t below = below_in_other(other, ray.k + i) - from;
    slope[i] = 0.5F * slope[i] + 0.25F * (beside[above] + beside[below]);
    variance[i] = 0.25F * variance[i] + 0.0625F * (beside_variance[above] + beside_variance[below]);
  }
}

template <std::size_t pixels>
void Panorama::predict_of(const Ray& ray, Column& temp_c, Column& known) const {
  const SweepEnds at(ray, 0);
  const auto width = static_cast<float>(2.0 * ray.half_width);
  const std::size_t first = index(0, ray.row_class) + ray.k;
  Pixels<pixels> swept, seen;
  sum_between(temp_sum_, at.low, at.high, first, swept);
  sum_between(seen_sum_, at.low, at.high, first, seen);
  for (std::size_t i = 0; i < pixels; ++i) {
    temp_c[ray.k + i] = swept[i] / width;
    known[ray.k + i] = seen[i] >= seen_enough * width ? 1.0F : 0.0F;
  }
}

template <std::size_t pixels>
void Panorama::seed_of(const Ray& ray, const Guess& guess) {
  const auto from = static_cast<std::ptrdiff_t>(std::floor(guess.low));
  const auto to = static_cast<std::ptrdiff_t>(std::floor(guess.high));
  constexpr auto all = static_cast<std::ptrdiff_t>(bins);
  note_change(from, to);
  for (std::ptrdiff_t bin = from; bin <= to; ++bin) {
    const std::size_t first = index(static_cast<std::size_t>((bin % all + all) % all), ray.row_class);
    const auto off_deg = static_cast<float>((static_cast<double>(bin) + 0.5 - ray.middle) * bin_deg);
    for (std::size_t k = ray.k; k < ray.k + pixels; ++k) {
      if (seen_[first + k] > 0.0F || std::isnan(guess.temp_c[k])) continue;
      seen_[first + k] = 1.0F;
      temp_c_[first + k] = guess.temp_c[k] + guess.slope[k] * off_deg;
      variance_[first + k] = guess.variance[k];
    }
  }
}

template <std::size_t pixels>
void Panorama::write_of(const Ray& ray, const Column& temp_c, const Column& variance) {
  const double low = ray.middle - ray.half_width, high = ray.middle + ray.half_width;
  const auto from = static_cast<std::ptrdiff_t>(std::floor(low));
  const auto to = static_cast<std::ptrdiff_t>(std::floor(high));
  note_change(from, to);
  const double share_of_bin = 1.0 / (high - low);
  const std::size_t first = ray.k, end = first + pixels;
  const auto share_of = [&](std::ptrdiff_t bin) {
    const auto begin = static_cast<double>(bin);
    return static_cast<float>((std::min(high, begin + 1.0) - std::max(low, begin)) * share_of_bin);
  };
  const auto first_of = [&](std::ptrdiff_t bin) { return index(bin_position(bin, 0.0F).bin, ray.row_class); };
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
    if (!things_move_ || squares <= outlier_nis) continue;
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

void Panorama::predict(const Ray& ray, std::ptrdiff_t reach, bool smooth, Predicted& predicted) const {
  ray.is_of_one ? predict_of<1>(ray, reach, smooth, predicted)
                : predict_of<half_rows>(ray, reach, smooth, predicted);
}

void Panorama::predict_mean(const Ray& ray, std::ptrdiff_t reach, Predicted& predicted) const {
  const SweepEnds at(ray, reach);
  ray.is_of_one ? predict_mean<1>(ray, at, reach, predicted)
                : predict_mean<half_rows>(ray, at, reach, predicted);
}

void Panorama::predict(const Ray& ray, Column& temp_c, Column& known) const {
  ray.is_of_one ? predict_of<1>(ray, temp_c, known) : predict_of<half_rows>(ray, temp_c, known);
}

void Panorama::seed(const Ray& ray, const Guess& guess) {
  ray.is_of_one ? seed_of<1>(ray, guess) : seed_of<half_rows>(ray, guess);
}

void Panorama::write(const Ray& ray, const Column& temp_c, const Column& variance) {
  ray.is_of_one ? write_of<1>(ray, temp_c, variance) : write_of<half_rows>(ray, temp_c, variance);
}

}  // namespace thermorig::odometer
