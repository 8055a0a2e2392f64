// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>

namespace thermorig::likelihood {

/// Of the pixels of a row in all halves of a window, half after half, for a scene of unit variance:
/// (halves * line_pixels) squared.
Eigen::MatrixXd window_covariance(std::size_t halves, double speed);

/// The same of what is left when the pixels of each half have lost their mean.
void centre_halves(Eigen::MatrixXd& covariance, std::size_t halves);

}  // namespace thermorig::likelihood
