// SPDX-License-Identifier: MIT
#include "alignment.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thermorig::odometer {

namespace {

constexpr double fewest_pixels = 40.0;
constexpr int steps = 4;
constexpr double longest_step_deg = 2.0;
constexpr double search_from_deg = 1.0;  // a heading that is known less well is searched for first
constexpr double search_step_deg = 0.5;
constexpr int most_search_steps = 40;  // to either side
constexpr float huber = 3.0F;
constexpr float most_left_k2 = 9.0F;  // of a pixel: what moves shows more
constexpr float strict_squares = 9.0F;
constexpr std::array<Slope, 3> slopes{{{1, false}, {2, true}, {4, true}}};

/// Of a squared residual in units of its variance.
float weight_of(float squares, bool is_strict) {
  if (is_strict) {
    const float part = 1.0F + squares / strict_squares;
    return 1.0F / (part * part);
  }
  return squares > huber * huber ? huber / std::sqrt(squares) : 1.0F;
}

double robust_squares(float left_c, float weight) {
  return double{std::min(left_c * left_c * weight, huber * huber * huber)};
}

}  // namespace

HalfPixels Alignment::beside_row(const View& view, double azimuth_deg) const {
  HalfPixels beside{};
  for (std::size_t column = 0; column < frame_columns; ++column)
    for (std::size_t k = 0; k < half_rows; ++k) {
      const std::size_t row = row_of(column, k, view.parity);
      const double map_row = std::clamp(lens_.map_row(column, row), 0.0, frame_rows - 1.0);
      const auto above = static_cast<std::size_t>(map_row);
      const std::size_t below = std::min(above + 1, frame_rows - 1);
      const auto shown_c = [&](std::size_t in_row) {
        Panorama::Column temp_c, known;
        panorama_.predict(ray_in_row(view, azimuth_deg, column, row, in_row), temp_c, known);
        return known[in_row / 2] > 0.0F ? temp_c[in_row / 2] : std::numeric_limits<float>::quiet_NaN();
      };
      const float part = static_cast<float>(map_row - static_cast<double>(above));
      const float more_c = std::lerp(shown_c(above), shown_c(below), part) - shown_c(row);
      if (!std::isnan(more_c)) beside[column * half_rows + k] = more_c;
    }
  return beside;
}

/// A column of the half less what the map shows.
void Alignment::Residuals::take(const View& view, std::size_t column, const Panorama::Predicted& predicted) {
  for (std::size_t k = 0; k < half_rows; ++k) {
    const std::size_t i = column * half_rows + k;
    const float temp_c = (*view.temp_c)[i];
    const bool is_compared = predicted.known[k] > 0.0F && !std::isnan(temp_c);
    residual[i] = is_compared ? temp_c - predicted.temp_c[k] : 0.0F;
    weight[i] = is_compared ? 1.0F / ((*view.variance)[i] + predicted.variance[k]) : 0.0F;
    weights += weight[i];
    sum += weight[i] * residual[i];
    flat_sum += is_compared ? weight[i] * temp_c : 0.0F;
  }
}

Alignment::Residuals Alignment::residuals(const View& view, double azimuth_deg) const {
  Residuals all;
  Panorama::Predicted predicted;
  for (std::size_t column = 0; column < frame_columns; ++column) {
    each_ray(view, azimuth_deg, column,
             [&](const Panorama::Ray& ray) { panorama_.predict_mean(ray, Slope().reach, predicted); });
    all.take(view, column, predicted);
  }
  return all;
}

Alignment::Fit Alignment::fit(const View& view, double azimuth_deg) const {
  const Residuals all = residuals(view, azimuth_deg);
  Fit fit;
  if (all.weights <= 0.0F) return fit;
  const float common_c = all.sum / all.weights;
  for (std::size_t i = 0; i < half_pixels; ++i) {
    if (all.weight[i] <= 0.0F) continue;
    fit.cost += robust_squares(all.residual[i] - common_c, all.weight[i]);
    fit.pixels += 1.0;
  }
  fit.cost /= fit.pixels;
  return fit;
}

Alignment::Comparison Alignment::compare(const View& view, double azimuth_deg, const Slope& slope) const {
  Comparison comparison;
  HalfPixels slopes_k_deg, slope_variance;
  Residuals all;
  for (std::size_t column = 0; column < frame_columns; ++column) {
    Panorama::Predicted predicted;
    each_ray(view, azimuth_deg, column,
             [&](const Panorama::Ray& ray) { panorama_.predict(ray, slope.reach, slope.smooth, predicted); });
    all.take(view, column, predicted);
    const std::size_t first = column * half_rows;
    std::copy(predicted.variance.begin(), predicted.variance.end(), &comparison.map_variance[first]);
    std::copy(predicted.of_azimuth.slope.begin(), predicted.of_azimuth.slope.end(), &slopes_k_deg[first]);
    std::copy(predicted.of_azimuth.variance.begin(), predicted.of_azimuth.variance.end(),
              &slope_variance[first]);
  }
  comparison.residual = all.residual;
  auto& [residual, weight, weights, sum, flat_sum] = all;
  if (weights <= 0.0F) return comparison;
  comparison.common_c = sum / weights;
  const auto trust_deg2 = static_cast<float>(view.trust_deg2);
  const float flat_c = flat_sum / weights;
  HalfPixels robust;
  for (std::size_t i = 0; i < half_pixels; ++i) {  // apart from the sums: side by side in registers
    const float left = all.residual[i] - comparison.common_c;
    const float explained = slopes_k_deg[i] * slopes_k_deg[i] * trust_deg2;
    robust[i] = weight_of(left * left / (1.0F / weight[i] + explained), view.is_strict);
  }
  float again = 0.0F, again_sum = 0.0F, slope_sum = 0.0F;
  double cost = 0.0, flat_cost = 0.0, squares_k2 = 0.0, pixels = 0.0;
  for (std::size_t i = 0; i < half_pixels; ++i) {  // outliers out, then what all have in common once more
    if (weight[i] <= 0.0F) continue;
    const float left = comparison.residual[i] - comparison.common_c;
    cost += robust_squares(left, weight[i]);
    flat_cost += robust_squares((*view.temp_c)[i] - flat_c, weight[i]);
    squares_k2 += double{std::min(left * left, most_left_k2)};
    pixels += 1.0;
    weight[i] *= robust[i];
    again += weight[i];
    again_sum += weight[i] * comparison.residual[i];
    slope_sum += weight[i] * slopes_k_deg[i];
  }
  comparison.cost = cost / pixels;
  comparison.flat_cost = flat_cost / pixels;
  comparison.squares_k2 = squares_k2 / pixels;
  comparison.pixels = pixels;
  comparison.common_c = again_sum / again;
  const float slope_mean = slope_sum / again;
  double shares = 0.0;
  for (std::size_t column = 0; column < frame_columns; ++column) {
    float gradient = 0.0F, curvature = 0.0F, noise = 0.0F;
    for (std::size_t i = column * half_rows; i < (column + 1) * half_rows; ++i) {
      if (weight[i] <= 0.0F) {
        comparison.residual[i] = std::numeric_limits<float>::quiet_NaN();
        continue;
      }
      comparison.residual[i] -= comparison.common_c;
      const float centred = slopes_k_deg[i] - slope_mean;
      gradient += weight[i] * centred * comparison.residual[i];
      curvature += weight[i] * centred * centred;
      noise += weight[i] * slope_variance[i];
    }
    comparison.gradient += double{gradient};
    comparison.curvature += double{curvature};
    comparison.known += double{curvature} - double{noise};
    shares += double{curvature};
    HeadingFilter::add_shares(azimuth_deg + lens_.bearing_deg(column), double{curvature}, comparison.about);
  }
  if (shares > 0.0)
    for (double& share : comparison.about) share /= shares;
  return comparison;
}

double Alignment::squares(const View& view, double azimuth_deg) const {
  HalfPixels expected, known;
  float sum = 0.0F, weights = 1e-6F, flat_sum = 0.0F, flat_weights = 1e-6F;
  for (std::size_t column = 0; column < frame_columns; ++column) {
    Panorama::Column temp_c, is_known;
    each_ray(view, azimuth_deg, column,
             [&](const Panorama::Ray& ray) { panorama_.predict(ray, temp_c, is_known); });
    for (std::size_t k = 0; k < half_rows; ++k) {
      const std::size_t i = column * half_rows + k;
      expected[i] = temp_c[k];
      known[i] = is_known[k];
      if (std::isnan((*view.temp_c)[i])) continue;
      const float weight = 1.0F / (*view.variance)[i];
      sum += known[i] * weight * ((*view.temp_c)[i] - expected[i]);
      weights += known[i] * weight;
      flat_sum += (1.0F - known[i]) * weight * (*view.temp_c)[i];
      flat_weights += (1.0F - known[i]) * weight;
    }
  }
  const float common_c = sum / weights, flat_c = flat_sum / flat_weights;
  double squares = 0.0;
  for (std::size_t i = 0; i < half_pixels; ++i) {
    if (std::isnan((*view.temp_c)[i])) continue;
    const float left = (*view.temp_c)[i] - (known[i] > 0.0F ? expected[i] + common_c : flat_c);
    squares += double{std::min(left * left / (*view.variance)[i], huber * huber * huber)};
  }
  return squares;
}

Alignment::Explained Alignment::explained(const View& view, double azimuth_deg) const {
  struct Sums {
    float weight = 0.0F, residual = 0.0F, temp_c = 0.0F;
  };
  std::array<Sums, frame_rows> rows{};
  const Residuals all = residuals(view, azimuth_deg);
  for (std::size_t column = 0; column < frame_columns; ++column)
    for (std::size_t k = 0; k < half_rows; ++k) {
      const std::size_t i = column * half_rows + k;
      if (all.weight[i] <= 0.0F) continue;
      Sums& row = rows[row_of(column, k, view.parity)];
      row.weight += all.weight[i];
      row.residual += all.weight[i] * all.residual[i];
      row.temp_c += all.weight[i] * (*view.temp_c)[i];
    }
  Explained explained;
  for (std::size_t column = 0; column < frame_columns; ++column)
    for (std::size_t k = 0; k < half_rows; ++k) {
      const std::size_t i = column * half_rows + k;
      if (all.weight[i] <= 0.0F) continue;
      const Sums& row = rows[row_of(column, k, view.parity)];
      const float left = all.residual[i] - row.residual / row.weight;
      const float shown = (*view.temp_c)[i] - row.temp_c / row.weight;
      explained.left += robust_squares(left, all.weight[i]) - 1.0;
      explained.structure += robust_squares(shown, all.weight[i]) - 1.0;
    }
  return explained;
}

double Alignment::searched(const View& view, double azimuth_deg, double sigma_deg, int& comparisons) const {
  // Compared before it becomes whole: after years without a sample sigma is beyond any int.
  const auto reach = static_cast<int>(std::min(double{most_search_steps}, 3.0 * sigma_deg / search_step_deg));
  double best_deg = azimuth_deg, best = std::numeric_limits<double>::infinity();
  for (int i = -reach; i <= reach; ++i) {
    const double tried_deg = azimuth_deg + i * search_step_deg;
    const Fit fit = this->fit(view, tried_deg);
    ++comparisons;
    if (fit.pixels < fewest_pixels) continue;
    const double off = i * search_step_deg / sigma_deg;
    const double cost = fit.cost + off * off / fit.pixels;
    if (cost >= best) continue;
    best = cost;
    best_deg = tried_deg;
  }
  return best_deg;
}

Alignment::Found Alignment::find(const View& view, double azimuth_deg, double sigma_deg) const {
  Found found;
  found.azimuth_deg = azimuth_deg;
  if (sigma_deg > search_from_deg)
    found.azimuth_deg = searched(view, azimuth_deg, sigma_deg, found.comparisons);
  Slope slope;
  double least_deg2 = std::numeric_limits<double>::infinity();
  for (const Slope& tried : slopes) {
    const Comparison comparison = compare(view, found.azimuth_deg, tried);
    ++found.comparisons;
    if (comparison.pixels < fewest_pixels || comparison.variance_deg2() >= least_deg2) continue;
    least_deg2 = comparison.variance_deg2();
    slope = tried;
    found.comparison = comparison;
  }
  if (!(least_deg2 < 25.0)) return found;
  for (int step = 0; step < steps; ++step) {
    const double step_deg = std::clamp(found.comparison.step_deg(), -longest_step_deg, longest_step_deg);
    found.azimuth_deg += step_deg;
    found.comparison = compare(view, found.azimuth_deg, slope);
    ++found.comparisons;
    if (found.comparison.pixels < fewest_pixels) return found;
    if (std::abs(step_deg) < 0.002) break;
  }
  found.is_found = found.comparison.variance_deg2() < 25.0;
  return found;
}

}  // namespace thermorig::odometer
