// SPDX-License-Identifier: MIT
#include "thermorig/simulation/panorama.h"

#include "scenes.h"
#include "thermorig/simulation/random.h"

namespace thermorig::simulation {

Panorama make_panorama(std::string_view environment, std::uint64_t seed) {
  Random random(seed, environment);
  if (environment == "dining") return dining_scene(random);
  if (environment == "kitchen") return kitchen_scene(random);
  if (environment == "garden") return garden_scene(random);
  return laboratory_scene(random);
}

}  // namespace thermorig::simulation
