// SPDX-License-Identifier: MIT
#include "optics.h"

#include <algorithm>
#include <cmath>

namespace thermorig::simulation {
namespace {

constexpr double response_sigma_pixels = 0.55;  // of the pixel's and the lens's response together

std::vector<double> bell(double sigma_samples, int reach) {
  std::vector<double> weights;
  double sum = 0.0;
  for (int i = -reach; i <= reach; ++i) {
    weights.push_back(std::exp(-0.5 * i * i / (sigma_samples * sigma_samples)));
    sum += weights.back();
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

/// The panorama's temperatures at every azimuth for one row of pixels.
std::vector<double> row_profile(const Panorama& panorama, double elevation, double sigma_deg) {
  std::vector<double> profile(Panorama::azimuths, 0.0);
  const auto row_of = [](double deg) {
    return (deg - Panorama::lowest_elevation_deg) / Panorama::elevation_step_deg;
  };
  const int low = std::max(0, static_cast<int>(row_of(elevation - 3.5 * sigma_deg)));
  const int high = std::min(Panorama::elevations - 1, static_cast<int>(row_of(elevation + 3.5 * sigma_deg)));
  double sum = 0.0;
  for (int row = low; row <= high; ++row) {
    const double offset_deg = Panorama::lowest_elevation_deg + row * Panorama::elevation_step_deg - elevation;
    const double weight = std::exp(-0.5 * offset_deg * offset_deg / (sigma_deg * sigma_deg));
    sum += weight;
    for (int azimuth = 0; azimuth < Panorama::azimuths; ++azimuth)
      profile[std::size_t(azimuth)] += weight * panorama.at(row, azimuth);
  }
  for (double& temp : profile) temp /= sum;
  return profile;
}

std::vector<double> blurred_around(const std::vector<double>& profile, double sigma_deg) {
  const double sigma = sigma_deg / Panorama::azimuth_step_deg;
  const int reach = static_cast<int>(std::ceil(3.5 * sigma));
  const auto weights = bell(sigma, reach);
  const int count = Panorama::azimuths;
  std::vector<double> blurred(profile.size(), 0.0);
  for (int azimuth = 0; azimuth < count; ++azimuth)
    for (int i = -reach; i <= reach; ++i)
      blurred[std::size_t(azimuth)] +=
          weights[std::size_t(i + reach)] * profile[std::size_t((azimuth + i + count) % count)];
  return blurred;
}

}  // namespace

FieldOfView FieldOfView::of_width(double width_deg) {
  const bool wide = width_deg > 80.0;
  return {width_deg, wide ? width_deg * 75.0 / 110.0 : width_deg * 35.0 / 55.0};
}

std::vector<double> blurred_row(const Panorama& panorama, const FieldOfView& view, double elevation_deg) {
  return blurred_around(row_profile(panorama, elevation_deg, response_sigma_pixels * view.row_pitch_deg()),
                        response_sigma_pixels * view.column_pitch_deg());
}

double row_elevation_deg(const FieldOfView& view, std::size_t row) {
  return (static_cast<double>(frame_rows - 1) / 2.0 - static_cast<double>(row)) * view.row_pitch_deg();
}

double column_azimuth_deg(const FieldOfView& view, bool mirrored, std::size_t column) {
  const double direction = mirrored ? -1.0 : 1.0;
  return direction * (static_cast<double>(column) - (frame_columns - 1) / 2.0) * view.column_pitch_deg();
}

Optics::Optics(const Panorama& panorama, const FieldOfView& view, bool mirrored)
    : strip_c_((std::size_t{Panorama::azimuths} + 1) * frame_rows) {
  for (std::size_t row = 0; row < frame_rows; ++row) {
    const auto profile = blurred_row(panorama, view, row_elevation_deg(view, row));
    for (std::size_t azimuth = 0; azimuth <= std::size_t{Panorama::azimuths}; ++azimuth)
      strip_c_[azimuth * frame_rows + row] = static_cast<float>(profile[azimuth % Panorama::azimuths]);
  }
  for (std::size_t column = 0; column < frame_columns; ++column)
    column_azimuth_deg_[column] = column_azimuth_deg(view, mirrored, column);
}

void Optics::view(double yaw_deg, PixelColumns& temp_c) const {
  for (std::size_t column = 0; column < frame_columns; ++column) {
    const double azimuth_deg = yaw_deg + column_azimuth_deg_[column];
    const double wrapped_deg = azimuth_deg - 360.0 * std::floor(azimuth_deg / 360.0);
    const double position = std::min(wrapped_deg / Panorama::azimuth_step_deg,
                                     static_cast<double>(Panorama::azimuths) * (1.0 - 1e-12));
    const auto left = static_cast<std::size_t>(position);
    const auto part = static_cast<float>(position - static_cast<double>(left));
    const float* strip = &strip_c_[left * frame_rows];
    float* out = &temp_c[column * frame_rows];
    for (std::size_t row = 0; row < frame_rows; ++row)
      out[row] = strip[row] + part * (strip[row + frame_rows] - strip[row]);
  }
}

}  // namespace thermorig::simulation
