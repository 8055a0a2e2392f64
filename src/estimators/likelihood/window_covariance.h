// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace thermorig::likelihood {

/// What two pixels of a row have in common, of a scene of unit variance, while the camera turns at a constant
/// speed. `distance`: between the middles of what they sweep; `speed`: what each sweeps, either sign.
double swept_covariance(double distance, double speed);

/// Where in the scene a pixel's sweep has its middle, from where column 0 looks in the middle of the window.
/// `half`: of so many halves, the oldest is 0. The line begins with column 0 in the oldest half, with column
/// 1 in the next one.
double place_of(std::size_t half, std::size_t halves, std::size_t pixel, double speed);

/// Of the pixels of a row in all halves of a window, half after half, for a scene of unit variance:
/// (halves * line_pixels) squared.
Eigen::MatrixXd window_covariance(std::size_t halves, double speed);

/// Of both classes of rows, the lines of the first one before those of the other, which is mirrored
/// (window_lines.h). `likeness`: what a row and those beside it have in common.
Eigen::MatrixXd covariance_of_classes(std::size_t halves, double speed, double likeness);

/// What the two classes have in common of a wave up the columns, 1: all of it. Rows are as like each other as
/// columns are: of the longest waves both see the same, of the shortest each its own.
double likeness_of_classes(std::size_t wave);

/// Of such lines what is left when the pixels of each half have lost their mean, class by class.
void centre_halves(Eigen::MatrixXd& covariance);

}  // namespace thermorig::likelihood
