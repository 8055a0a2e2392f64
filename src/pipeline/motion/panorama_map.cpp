// SPDX-License-Identifier: MIT
#include "panorama_map.h"

#include <algorithm>
#include <cmath>

namespace thermorig::motion {
namespace {

constexpr std::size_t cell_values = 2 * half_rows;  // of one bin
constexpr float least_map_weight = 1.5F;            // a single reading is no map
constexpr double farthest_deg = 1e8;
constexpr double most_bins = 20000.0;  // fifty turns: no window of a rig's goes so far

}  // namespace

PanoramaMap::PanoramaMap(double bin_deg, bool closed, double lowest_deg, double span_deg)
    : bin_deg_(closed ? whole_turn_deg / std::round(whole_turn_deg / bin_deg) : bin_deg),
      lowest_deg_(closed ? 0.0 : lowest_deg),
      closed_(closed),
      bins_(static_cast<std::uint32_t>(
          closed ? std::lround(whole_turn_deg / bin_deg_)
                 : std::lround(std::ceil(std::min(span_deg / bin_deg_, most_bins))) + 2)),
      weight_(bins_ * cell_values),
      sum_(weight_.size()),
      reach_(weight_.size()),
      mean_(weight_.size()),
      slope_(weight_.size()),
      known_(weight_.size()) {}

/// Whole numbers are cut off as 32-bit ones, which every processor does for several columns at once; no rig
/// turns so far that they would not do.
PanoramaMap::Place PanoramaMap::place(double angle_deg, double pitch_deg, bool mirrored) const {
  const double highest = static_cast<double>(bins_) - (closed_ ? 1e-6 : 1.0 + 1e-6);
  const double step = (mirrored ? -pitch_deg : pitch_deg) / bin_deg_;
  const double first = (angle_deg - lowest_deg_) / bin_deg_ - 0.5 * (frame_columns - 1) * step;
  const double turns_per_bin = 1.0 / bins_;
  Place place;
  const bool is_somewhere = std::abs(angle_deg) < farthest_deg;
  for (std::size_t column = 0; column < frame_columns; ++column) {
    double position = is_somewhere ? first + static_cast<double>(column) * step : 0.0;
    if (closed_) {
      const double turns = position * turns_per_bin;
      const auto cut = static_cast<double>(static_cast<std::int32_t>(turns));
      position -= bins_ * (cut > turns ? cut - 1.0 : cut);
    }
    position = std::clamp(position, 0.0, highest);
    const auto left = static_cast<std::int32_t>(position);
    place.left[column] = static_cast<std::uint32_t>(left);
    place.part[column] = static_cast<float>(position - left);
  }
  for (std::size_t column = 0; column < frame_columns; ++column)
    place.right[column] = place.left[column] + 1 == bins_ ? 0 : place.left[column] + 1;
  return place;
}

void PanoramaMap::clear() {
  std::fill(weight_.begin(), weight_.end(), 0.0F);
  std::fill(sum_.begin(), sum_.end(), 0.0F);
  std::fill(reach_.begin(), reach_.end(), 0.0F);
}

std::uint32_t PanoramaMap::neighbour(std::uint32_t bin, int step) const {
  const auto next = static_cast<std::int64_t>(bin) + step;
  if (closed_) return static_cast<std::uint32_t>((next + bins_) % bins_);
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(next, 0, bins_ - 1));
}

void PanoramaMap::find_slopes() {
  const auto run = static_cast<float>(2.0 * bin_deg_);
  for (std::uint32_t bin = 0; bin < bins_; ++bin) {
    const std::size_t here = bin * cell_values;
    const std::size_t left = neighbour(bin, -1) * cell_values;
    const std::size_t right = neighbour(bin, 1) * cell_values;
    for (std::size_t k = 0; k < cell_values; ++k) {
      const bool known = weight_[here + k] > least_map_weight && weight_[left + k] > least_map_weight &&
                         weight_[right + k] > least_map_weight;
      known_[here + k] = known ? 1.0F : 0.0F;
      slope_[here + k] = known ? (mean_[right + k] - mean_[left + k]) / run : 0.0F;
    }
  }
}

/// The readings of a bin do not lie around its middle evenly: what their mean lies off it, times the slope,
/// is taken out.
void PanoramaMap::finish() {
  for (std::size_t i = 0; i < weight_.size(); ++i) mean_[i] = weight_[i] > 0.0F ? sum_[i] / weight_[i] : 0.0F;
  find_slopes();
  const auto bin_deg = static_cast<float>(bin_deg_);
  for (int pass = 0; pass < 2; ++pass) {
    for (std::size_t i = 0; i < weight_.size(); ++i)
      if (known_[i] > 0.0F) mean_[i] = (sum_[i] - slope_[i] * reach_[i] * bin_deg) / weight_[i];
    find_slopes();
  }
}

double PanoramaMap::freedom() const {
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
    const std::size_t here = bin * cell_values;
    const std::size_t left = neighbour(bin, -1) * cell_values;
    const std::size_t right = neighbour(bin, 1) * cell_values;
    for (std::size_t k = 0; k < cell_values; ++k)
      if (known_[here + k] > 0.0F)
        sum += static_cast<double>(weight_[here + k]) * (1.0 / weight_[left + k] + 1.0 / weight_[right + k]);
  }
  // A mean of tents weighs readings unequally: its variance is about two thirds of one over the weight.
  return sum * noise_variance * (2.0 / 3.0) / (4.0 * bin_deg_ * bin_deg_);
}

}  // namespace thermorig::motion
