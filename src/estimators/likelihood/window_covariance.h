// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace thermorig::likelihood {

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
