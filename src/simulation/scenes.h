// SPDX-License-Identifier: MIT
#pragma once

#include "random.h"
#include "thermorig/simulation/panorama.h"

namespace thermorig::simulation {

Panorama laboratory_scene(Random& random);
Panorama dining_scene(Random& random);
Panorama kitchen_scene(Random& random);
Panorama garden_scene(Random& random);

/// With other differences of temperature, about the same mean. 1 changes nothing.
Panorama with_contrast(Panorama panorama, double contrast);

}  // namespace thermorig::simulation
