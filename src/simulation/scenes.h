// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/simulation/panorama.h"
#include "thermorig/simulation/random.h"

namespace thermorig::simulation {

Panorama laboratory_scene(Random& random);
Panorama dining_scene(Random& random);
Panorama kitchen_scene(Random& random);
Panorama garden_scene(Random& random);

}  // namespace thermorig::simulation
