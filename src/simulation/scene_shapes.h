// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "random.h"
#include "thermorig/simulation/panorama.h"

namespace thermorig::simulation {

/// A rectangle in angles; azimuths wrap around.
struct Patch {
  double azimuth_deg = 0.0;  // of its middle
  double width_deg = 0.0;
  double low_deg = 0.0;  // elevations
  double high_deg = 0.0;
};

void add_to_patch(Panorama& panorama, const Patch& patch, double delta_k);
void fill_patch(Panorama& panorama, const Patch& patch, double temp_c);

/// The ellipse that fills the patch.
void fill_ellipse(Panorama& panorama, const Patch& patch, double temp_c);

/// A bell-shaped spot with the patch's half-widths as standard deviations.
void add_spot(Panorama& panorama, const Patch& patch, double delta_k);

/// Somebody 1.7 m tall, 1.2 to 4.5 m away: clothes at 27.5 to 30.5 degC, head at 32 to 34 degC.
void add_person(Panorama& panorama, Random& random);

double elevation_deg(int row);
double any_azimuth(Random& random);

/// Cloud-like texture with mean 0, standard deviation 1, and amplitudes that fall with f^-1.2; (181, 1440).
std::vector<float> fractal_texture(Random& random);

}  // namespace thermorig::simulation
