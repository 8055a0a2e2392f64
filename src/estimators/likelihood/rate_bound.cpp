// SPDX-License-Identifier: MIT
#include "thermorig/estimators/likelihood/rate_bound.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "speed_table.h"
#include "thermorig/core/frame.h"
#include "window_covariance.h"
#include "window_lines.h"

namespace thermorig::likelihood {

namespace {

constexpr double whole_turn_deg = 360.0;
constexpr double unknown_offset = 1e4;  // variance of what a half has in common, in the noise's
constexpr double least_information = 1e-12;
constexpr double most_steps = 200.0;  // through a sweep, a column of the panorama each

/// The panorama, column after column, smoothed over three: a map's noise would be taken for structure.
class Columns {
 public:
  using Column = std::array<double, frame_rows>;

  explicit Columns(const PanoramaImage& panorama) : columns_(panorama.image_c.size() / frame_rows) {
    const std::size_t count = columns_.size();
    for (std::size_t column = 0; column < count; ++column)
      for (std::size_t row = 0; row < frame_rows; ++row) {
        const auto at = [&](std::size_t c) { return double{panorama.image_c[row * count + c % count]}; };
        columns_[column][row] = 0.5 * at(column) + 0.25 * (at(column + 1) + at(column + count - 1));
      }
  }

  double step_deg() const { return whole_turn_deg / static_cast<double>(columns_.size()); }

  /// At an azimuth: what stands there, and its slope by azimuth.
  void look(double azimuth_deg, Column& temp_c, Column& slope) const {
    const auto count = static_cast<double>(columns_.size());
    const double turns = (azimuth_deg - 0.5 * step_deg()) / whole_turn_deg;  // of the columns' middles
    const double place = (turns - std::floor(turns)) * count;
    const std::size_t left = std::min(columns_.size() - 1, static_cast<std::size_t>(place));
    const double part = place - static_cast<double>(left);
    const auto at = [&](std::size_t offset) -> const Column& {  // from the one before
      return columns_[(left + offset + columns_.size() - 1) % columns_.size()];
    };
    for (std::size_t row = 0; row < frame_rows; ++row) {
      temp_c[row] = std::lerp(at(1)[row], at(2)[row], part);
      slope[row] = std::lerp(at(2)[row] - at(0)[row], at(3)[row] - at(1)[row], part) / (2.0 * step_deg());
    }
  }

 private:
  std::vector<Column> columns_;
};

/// What a half shows, and how it changes with the rate and with the heading.
struct HalfGradients {
  HalfLines temp_c{}, by_rate{}, by_heading{};
};

HalfGradients gradients_of(const ExposedHalf& half, const BoundedWindow& window, double middle_s,
                           const Columns& columns, const CameraProfile& camera) {
  const double pitch_deg = camera.lens_width_deg() / static_cast<double>(frame_columns);
  const double direction = camera.mirrored ? -1.0 : 1.0;
  const double sweep_deg = std::abs(window.rate_dps) * (half.end_s - half.begin_s);
  const int steps = 2 + static_cast<int>(std::min(most_steps, sweep_deg / columns.step_deg()));
  HalfGradients gradients;
  Columns::Column temp_c, slope;
  for (std::size_t column = 0; column < frame_columns; ++column)
    for (int step = 0; step < steps; ++step) {
      const double time_s = std::lerp(half.begin_s, half.end_s, (step + 0.5) / steps) - middle_s;
      const double bearing_deg =
          direction * pitch_deg * (static_cast<double>(column) - 0.5 * (frame_columns - 1));
      columns.look(window.heading_deg + window.rate_dps * time_s + bearing_deg, temp_c, slope);
      for (std::size_t row = (column ^ half.parity) & 1U; row < frame_rows; row += 2) {
        gradients.temp_c[row][column / 2] += static_cast<float>(temp_c[row] / steps);
        gradients.by_rate[row][column / 2] += static_cast<float>(slope[row] * time_s / steps);
        gradients.by_heading[row][column / 2] += static_cast<float>(slope[row] / steps);
      }
    }
  return gradients;
}

/// By waves, as a window's readings are.
WindowLines lines_of(const std::vector<HalfGradients>& gradients, HalfLines HalfGradients::*member,
                     unsigned parity) {
  std::vector<const HalfLines*> halves;
  for (const HalfGradients& half : gradients) halves.push_back(&(half.*member));
  WindowLines lines(halves.size());
  lines.set(parity, halves);
  return lines;
}

/// (lines of both classes of rows, 2): of one wave, by rate and by heading.
Eigen::MatrixX2d columns_of(const WindowLines& by_rate, const WindowLines& by_heading, std::size_t wave) {
  const std::size_t lines = by_rate.lines();
  Eigen::MatrixX2d columns(static_cast<Eigen::Index>(2 * lines), 2);
  for (std::size_t i = 0; i < 2 * lines; ++i) {
    const std::size_t row_class = i / lines, at = i % lines * half_rows + wave;
    columns.row(static_cast<Eigen::Index>(i)) << double{by_rate.waves(row_class)[at]},
        double{by_heading.waves(row_class)[at]};
  }
  return columns;
}

/// What readings tell of rate and heading, in units of the noise's variance, if the scene is known but for
/// its own covariance, and where `has_offsets` but for what the readings of a half have in common.
Eigen::Matrix2d information_of(const Eigen::MatrixX2d& by, Eigen::MatrixXd covariance, bool has_offsets) {
  constexpr auto pixels = static_cast<Eigen::Index>(line_pixels);
  covariance.diagonal().array() += 1.0;
  if (has_offsets)
    for (Eigen::Index half = 0; half < covariance.rows(); half += pixels)
      covariance.block(half, half, pixels, pixels).array() += unknown_offset;
  return by.transpose() * Eigen::LLT<Eigen::MatrixXd>(covariance).solve(by);
}

/// What a scene shows in both classes of rows, and in one of them less what halves have in common.
struct SceneCovariance {
  SceneCovariance(std::size_t halves, double speed)
      : lines(static_cast<Eigen::Index>(halves * line_pixels)),
        classes(covariance_of_classes(halves, speed, 1.0)) {
    Eigen::MatrixXd centred = classes.topLeftCorner(lines, lines);
    centre_halves(centred);
    centred_trace = centred.trace();
  }

  Eigen::Matrix2d information(const Eigen::MatrixX2d& by, double contrast, std::size_t wave) const {
    const bool has_offsets = wave == 0;
    if (wave < shared_waves) {
      Eigen::MatrixXd scene = contrast * classes;
      const double likeness = likeness_of_classes(wave);
      scene.topRightCorner(lines, lines) *= likeness;
      scene.bottomLeftCorner(lines, lines) *= likeness;
      return information_of(by, scene, has_offsets);
    }
    return information_of(by.topRows(lines), contrast * classes.topLeftCorner(lines, lines), has_offsets) +
           information_of(by.bottomRows(lines), contrast * classes.bottomRightCorner(lines, lines),
                          has_offsets);
  }
  double trace(std::size_t wave) const {
    return wave == 0 ? centred_trace : classes.topLeftCorner(lines, lines).trace();
  }

  Eigen::Index lines;  // of a class
  Eigen::MatrixXd classes;
  double centred_trace = 0.0;
};

}  // namespace

double rate_bound_dps(const BoundedWindow& window, const PanoramaImage& panorama,
                      const CameraProfile& camera) {
  const Columns columns(panorama);
  const std::size_t halves = window.halves.size();
  const double begin_s = window.halves.front().begin_s, end_s = window.halves.back().end_s;
  std::vector<HalfGradients> gradients;
  for (const ExposedHalf& half : window.halves)
    gradients.push_back(gradients_of(half, window, 0.5 * (begin_s + end_s), columns, camera));
  const unsigned parity = window.halves.front().parity;
  const WindowLines shown = lines_of(gradients, &HalfGradients::temp_c, parity);
  const WindowLines by_rate = lines_of(gradients, &HalfGradients::by_rate, parity);
  const WindowLines by_heading = lines_of(gradients, &HalfGradients::by_heading, parity);
  const double pitch_deg = camera.lens_width_deg() / static_cast<double>(frame_columns);
  const double speed = (camera.mirrored ? -1.0 : 1.0) * window.rate_dps * (end_s - begin_s) /
                       (static_cast<double>(halves) * pitch_deg);
  const double noise_variance = window.noise_c * window.noise_c;
  const SceneCovariance scene(halves, speed);
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  for (std::size_t wave = 0; wave < half_rows; ++wave) {
    const double contrast = shown.energy(wave) / (2.0 * scene.trace(wave) * noise_variance);
    if (!std::isfinite(contrast)) return std::numeric_limits<double>::quiet_NaN();
    information += scene.information(columns_of(by_rate, by_heading, wave), contrast, wave);
  }
  information /= noise_variance;
  // What the rate shares with the heading is not known of it.
  const double left = information(0, 0) -
                      information(0, 1) * information(1, 0) / std::max(least_information, information(1, 1));
  return left > least_information ? 1.0 / std::sqrt(left) : std::numeric_limits<double>::infinity();
}

}  // namespace thermorig::likelihood
