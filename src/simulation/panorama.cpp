// SPDX-License-Identifier: MIT
#include "thermorig/simulation/panorama.h"

#include <algorithm>
#include <array>

#include "random.h"
#include "scenes.h"
#include "thermorig/core/error.h"
#include "thermorig/core/nearest_name.h"

namespace thermorig::simulation {

namespace {

struct Scene {
  std::string_view name;
  Panorama (*make)(Random& random);
};

constexpr std::array scenes{Scene{"laboratory", laboratory_scene}, Scene{"dining", dining_scene},
                            Scene{"kitchen", kitchen_scene}, Scene{"garden", garden_scene}};

const Scene* find_scene(std::string_view name) {
  const auto* found =
      std::find_if(scenes.begin(), scenes.end(), [&](const Scene& scene) { return scene.name == name; });
  return found == scenes.end() ? nullptr : found;
}

}  // namespace

Panorama with_contrast(Panorama panorama, double contrast) {
  if (contrast == 1.0) return panorama;
  double sum_c = 0.0;
  for (const float temp_c : panorama.temp_c) sum_c += temp_c;
  const double mean_c = sum_c / static_cast<double>(panorama.temp_c.size());
  for (float& temp_c : panorama.temp_c) temp_c = static_cast<float>(mean_c + contrast * (temp_c - mean_c));
  return panorama;
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const Scene& scene : scenes) names.emplace_back(scene.name);
  return names;
}

std::string scene_of(std::string_view environment) {
  return std::string(find_scene(environment) == nullptr ? scenes.front().name : environment);
}

Panorama make_panorama(std::string_view environment, std::uint64_t seed, std::string_view scene) {
  const Scene* found = find_scene(scene.empty() ? scene_of(environment) : scene);
  if (found == nullptr)
    throw Error(ExitCode::bad_usage, "the simulated rig has no scene \"" + std::string(scene) + '"',
                "--scene", advice_on_name(scene, scene_names()));
  Random random(seed, environment);
  return found->make(random);
}

}  // namespace thermorig::simulation
