// SPDX-License-Identifier: MIT
#include "frame_statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace thermorig::simulation {
namespace {

double correlation(const std::vector<double>& left, const std::vector<double>& right) {
  const double left_mean = mean_of(left);
  const double right_mean = mean_of(right);
  double product = 0.0;
  for (std::size_t i = 0; i < left.size(); ++i) product += (left[i] - left_mean) * (right[i] - right_mean);
  return product / static_cast<double>(left.size()) / deviation_of(left) / deviation_of(right);
}

std::vector<double> image(const ThermalFrame& frame) {
  return {frame.temp_c.begin(), frame.temp_c.end()};
}

/// The fresh readings of one pixel: a held value is left out.
std::vector<double> readings(const std::vector<SimulatedFrame>& frames, std::size_t pixel) {
  std::vector<double> values;
  for (const auto& frame : frames)
    if (values.empty() || values.back() != static_cast<double>(frame.frame.temp_c[pixel]))
      values.push_back(frame.frame.temp_c[pixel]);
  return values;
}

/// Autocorrelation of the differences around the images' own mean, which takes the common mode out.
double lag_one(const std::vector<double>& values) {
  std::vector<double> before;
  std::vector<double> after;
  for (std::size_t i = 2; i < values.size(); ++i) {
    before.push_back(values[i - 1] - values[i - 2]);
    after.push_back(values[i] - values[i - 1]);
  }
  return correlation(before, after);
}

std::vector<double> mean_image(const std::vector<SimulatedFrame>& frames) {
  std::vector<double> mean(frame_pixels, 0.0);
  for (const auto& frame : frames)
    for (std::size_t i = 0; i < frame_pixels; ++i)
      mean[i] += static_cast<double>(frame.frame.temp_c[i]) / static_cast<double>(frames.size());
  return mean;
}

/// Pixel minus the mean of its four neighbours, everywhere but at the edge.
std::vector<double> neighbour_residuals(const std::vector<double>& mean) {
  std::vector<double> residuals;
  for (std::size_t row = 1; row + 1 < frame_rows; ++row)
    for (std::size_t column = 1; column + 1 < frame_columns; ++column) {
      const std::size_t i = row * frame_columns + column;
      residuals.push_back(
          mean[i] - (mean[i - 1] + mean[i + 1] + mean[i - frame_columns] + mean[i + frame_columns]) / 4.0);
    }
  return residuals;
}

double robust_deviation(const std::vector<double>& values) {
  const double middle = median_of(values);
  std::vector<double> distances;
  for (const double value : values) distances.push_back(std::abs(value - middle));
  return 1.4826 * median_of(distances);
}

/// Half of the median difference between even and odd residuals is the offset of each half.
double chess_offset(const std::vector<double>& mean) {
  std::vector<double> even;
  std::vector<double> odd;
  const auto residuals = neighbour_residuals(mean);
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const bool is_even = subpage_of(i / (frame_columns - 2) + 1, i % (frame_columns - 2) + 1) == 0;
    (is_even ? even : odd).push_back(residuals[i]);
  }
  return (median_of(even) - median_of(odd)) / 2.0;
}

double common_mode(const std::vector<SimulatedFrame>& frames) {
  std::vector<double> means;
  for (const auto& frame : frames) {
    std::vector<double> even;
    for (std::size_t row = 0; row < frame_rows; ++row)
      for (std::size_t column = row & 1U; column < frame_columns; column += 2)
        even.push_back(frame.frame.temp_c[row * frame_columns + column]);
    const double mean = median_of(even);
    if (means.empty() || means.back() != mean) means.push_back(mean);
  }
  return deviation_of(means);
}

bool is_corner(std::size_t row, std::size_t column) {
  return (row < 3 || row >= frame_rows - 3) && (column < 3 || column >= frame_columns - 3);
}

bool is_centre(std::size_t row, std::size_t column) {
  return row >= 8 && row < 16 && column >= 12 && column < 20;
}

}  // namespace

double quantile_of(std::vector<double> values, double part) {
  const auto place = static_cast<std::ptrdiff_t>(part * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

double median_of(std::vector<double> values) {
  return quantile_of(std::move(values), 0.5);
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double deviation_of(const std::vector<double>& values) {
  const double mean = mean_of(values);
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size()));
}

StillStatistics still_statistics(const std::vector<SimulatedFrame>& frames) {
  const auto mean = mean_image(frames);
  const auto first = image(frames.front().frame);
  std::vector<double> all, centre, corner, lags, living;
  for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel) {
    const auto values = readings(frames, pixel);
    if (values.size() < 4) continue;  // a dead pixel
    const double noise_k = deviation_of(values);
    all.push_back(noise_k);
    living.push_back(mean[pixel]);
    if (is_centre(pixel / frame_columns, pixel % frame_columns)) centre.push_back(noise_k);
    if (is_corner(pixel / frame_columns, pixel % frame_columns)) corner.push_back(noise_k);
    lags.push_back(lag_one(values));
  }
  return {.noise_median_k = median_of(all),
          .noise_centre_k = median_of(centre),
          .noise_corner_k = median_of(corner),
          .lag_one = median_of(lags),
          .common_mode_k = common_mode(frames),
          .pattern_k = robust_deviation(neighbour_residuals(mean)),
          .chess_offset_k = chess_offset(mean),
          .spatial_k = deviation_of(living),
          .low_c = quantile_of(first, 0.01),
          .high_c = quantile_of(first, 0.99),
          .repeat_correlation = correlation(first, image(frames[2].frame))};
}

}  // namespace thermorig::simulation
