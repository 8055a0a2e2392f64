// SPDX-License-Identifier: MIT
#pragma once

#include "random.h"
#include "thermorig/simulation/panorama.h"

namespace thermorig::simulation {

Panorama laboratory_scene(Random& random);
Panorama dining_scene(Random& random);
Panorama kitchen_scene(Random& random);
Panorama garden_scene(Random& random);

}  // namespace thermorig::simulation
