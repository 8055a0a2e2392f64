// SPDX-License-Identifier: MIT
#include "panorama_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thermorig::motion {
namespace {

constexpr std::uint32_t bin_values = 2 * half_rows;
constexpr float least_map_weight = 1.5F;  // a single reading is no map
constexpr int passes = 3;                 // of means and slopes, each of which rests on the other
constexpr double farthest_deg = 1e8;
constexpr double most_bins = 20000.0;  // fifty turns: no window of a rig's goes so far

Eigen::Map<Eigen::ArrayXf, Eigen::Aligned16> values(PanoramaMap::Cells& cells) {
  return {cells.data(), static_cast<Eigen::Index>(cells.size())};
}

}  // namespace

PanoramaMap::PanoramaMap(double bin_deg, bool closed, double lowest_deg, double span_deg)
    : bin_deg_(closed ? whole_turn_deg / std::round(whole_turn_deg / bin_deg) : bin_deg),
      lowest_deg_(closed ? 0.0 : lowest_deg),
      closed_(closed),
      bins_(static_cast<std::uint32_t>(
          closed ? std::lround(whole_turn_deg / bin_deg_)
                 : std::lround(std::ceil(std::min(span_deg / bin_deg_, most_bins))) + 2)),
      weight_(bins_ * bin_values),
      sum_(weight_.size()),
      reach_(weight_.size()),
      mean_(weight_.size()),
      slope_(weight_.size()),
      known_(weight_.size()),
      rise_(weight_.size()),
      both_known_(weight_.size()) {}

/// Whole numbers have 32 bits, which every processor converts several at once; no rig turns so far that they
/// would not do.
PanoramaMap::Place PanoramaMap::place(double angle_deg, double pitch_deg, bool mirrored,
                                      unsigned parity) const {
  const double bins = bins_, turns_per_bin = 1.0 / bins_;
  const double highest = bins - (closed_ ? 1e-6 : 1.0 + 1e-6);
  const bool is_somewhere = std::abs(angle_deg) < farthest_deg;
  const double step = is_somewhere ? (mirrored ? -pitch_deg : pitch_deg) / bin_deg_ : 0.0;
  const double first =
      is_somewhere ? (angle_deg - lowest_deg_) / bin_deg_ - 0.5 * (frame_columns - 1) * step : 0.0;
  Eigen::Array<double, frame_columns, 1> positions;
  std::int32_t number = 0;
  for (double& position : positions) position = first + step * number++;
  if (closed_) positions -= bins * (positions * turns_per_bin).floor();
  positions = positions.max(0.0).min(highest);
  Place place;
  for (std::uint32_t column = 0; column < frame_columns; ++column) {
    const auto bin = static_cast<std::int32_t>(positions[column]);
    place.left[column] = static_cast<std::uint32_t>(bin);
    place.part[column] = static_cast<float>(positions[column] - bin);
  }
  for (std::uint32_t column = 0; column < frame_columns; ++column) {
    const std::uint32_t bin = place.left[column];
    const std::uint32_t cell = ((column ^ parity) & 1U) * half_rows;
    place.left[column] = bin * bin_values + cell;
    place.right[column] = (bin + 1 == bins_ ? 0 : bin + 1) * bin_values + cell;
  }
  return place;
}

void PanoramaMap::clear() {
  std::fill(weight_.begin(), weight_.end(), 0.0F);
  std::fill(sum_.begin(), sum_.end(), 0.0F);
  std::fill(reach_.begin(), reach_.end(), 0.0F);
}

/// Where the arrays begin is looked up once: to a compiler, vectors written there might change it.
void PanoramaMap::add(const Place& place, const HalfPixels& values, const HalfPixels& weights) {
  float* const weight = weight_.data();
  float* const reach = reach_.data();
  float* const sum = sum_.data();
  for (std::size_t column = 0; column < frame_columns; ++column) {
    const auto [left, right, part] = between(place, column);
    const ColumnPixels value = column_of(values, column);
    const ColumnPixels to_right = part * column_of(weights, column);
    const ColumnPixels to_left = column_of(weights, column) - to_right;
    ColumnOf(weight + left) += to_left;
    ColumnOf(reach + left) += to_left * part;
    ColumnOf(sum + left) += to_left * value;
    ColumnOf(weight + right) += to_right;
    ColumnOf(reach + right) += to_right * (part - 1.0F);
    ColumnOf(sum + right) += to_right * value;
  }
}

std::uint32_t PanoramaMap::neighbour(std::uint32_t bin, int step) const {
  const auto next = static_cast<std::int64_t>(bin) + step;
  if (closed_) return static_cast<std::uint32_t>((next + bins_) % bins_);
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(next, 0, bins_ - 1));
}

/// `look` gets values `here` .. `here + count - 1`, and where those of the bins beside them begin: all bins
/// within the map at once, then the two at its ends.
template <typename Look>
void PanoramaMap::look_aside(Look look) {
  const std::uint32_t last = bins_ - 1;
  look(bin_values, (last - 1) * bin_values, 0, 2 * bin_values);
  look(0, bin_values, neighbour(0, -1) * bin_values, neighbour(0, 1) * bin_values);
  look(last * bin_values, bin_values, neighbour(last, -1) * bin_values, neighbour(last, 1) * bin_values);
}

void PanoramaMap::find_known() {
  look_aside([this](std::size_t here, std::size_t count, std::size_t left, std::size_t right) {
    for (std::size_t k = 0; k < count; ++k) {
      const float least = std::min({weight_[here + k], weight_[left + k], weight_[right + k]});
      known_[here + k] = least > least_map_weight ? 1.0F : 0.0F;
    }
  });
}

/// The readings of a bin do not lie around its middle evenly: what their mean lies off it, times the slope,
/// is taken out. Nothing is, where no slope is known.
void PanoramaMap::find_means() {
  values(mean_) = (values(sum_) - values(slope_) * values(reach_) * static_cast<float>(bin_deg_)) /
                  values(weight_).max(std::numeric_limits<float>::min());
}

void PanoramaMap::find_slopes() {
  const auto run = static_cast<float>(2.0 * bin_deg_);
  look_aside([&](std::size_t here, std::size_t count, std::size_t left, std::size_t right) {
    values(slope_).segment(here, count) =
        values(known_).segment(here, count) *
        ((values(mean_).segment(right, count) - values(mean_).segment(left, count)) / run);
  });
}

void PanoramaMap::find_rises() {
  look_aside([this](std::size_t here, std::size_t count, std::size_t, std::size_t right) {
    values(rise_).segment(here, count) =
        values(mean_).segment(right, count) - values(mean_).segment(here, count);
    values(both_known_).segment(here, count) =
        values(known_).segment(here, count) * values(known_).segment(right, count);
  });
}

void PanoramaMap::finish() {
  find_known();
  values(slope_).setZero();
  for (int pass = 0; pass < passes; ++pass) {
    find_means();
    find_slopes();
  }
  find_rises();
}

double PanoramaMap::parameters() const {
  return static_cast<double>(
      std::count_if(weight_.begin(), weight_.end(), [](float weight) { return weight > 0.0F; }));
}

double PanoramaMap::slope_squared() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < slope_.size(); ++i)
    sum += static_cast<double>(weight_[i]) * slope_[i] * slope_[i];
  return sum;
}

double PanoramaMap::slope_noise(double noise_variance) const {
  double sum = 0.0;
  for (std::uint32_t bin = 0; bin < bins_; ++bin) {
    const std::size_t here = bin * bin_values;
    const std::size_t left = neighbour(bin, -1) * bin_values;
    const std::size_t right = neighbour(bin, 1) * bin_values;
    for (std::size_t k = 0; k < bin_values; ++k)
      if (known_[here + k] > 0.0F)
        sum += static_cast<double>(weight_[here + k]) * (1.0 / weight_[left + k] + 1.0 / weight_[right + k]);
  }
  // A mean of tents weighs readings unequally: its variance is about two thirds of one over the weight.
  return sum * noise_variance * (2.0 / 3.0) / (4.0 * bin_deg_ * bin_deg_);
}

}  // namespace thermorig::motion
