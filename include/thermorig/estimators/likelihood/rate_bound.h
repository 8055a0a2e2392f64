// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "thermorig/core/profile.h"

namespace thermorig::likelihood {

/// A chess half of a window.
struct ExposedHalf {
  unsigned parity = 0;
  double begin_s = 0.0, end_s = 0.0;
};

/// Where a window looks.
struct BoundedWindow {
  std::span<const ExposedHalf> halves;  // at least 2 from the oldest on, of alternating parity
  double heading_deg = 0.0;             // in the middle of the window, the panorama's first column is 0
  double rate_dps = 0.0;                // constant
  double noise_c = 0.6;                 // standard deviation of a reading, above 0
};

/// The surroundings all around the axis: (frame_rows, columns) from the top, in degrees Celsius, columns
/// growing as angles do. NaN: never seen.
struct PanoramaImage {
  std::span<const float> image_c;
};

/// Hybrid Cramer-Rao bound of a window's rate, deg/s: no unbiased estimator that has nothing but these images
/// is better on average. Not known to it are the heading, what each half has in common, and the scene, of
/// which it knows how its parts go together (a Gaussian process with the contrast that the window has); the
/// gradients are those of the panorama. NaN where a pixel looks at what was never seen; infinite where
/// nothing depends on the rate. Source: Van Trees and Bell, "Bayesian Bounds" (2007), hybrid bound.
double rate_bound_dps(const BoundedWindow& window, const PanoramaImage& panorama,
                      const CameraProfile& camera);

}  // namespace thermorig::likelihood
