// SPDX-License-Identifier: MIT
#include "map_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "thermorig/core/printable.h"

namespace thermorig::app {

namespace {

struct Temperatures {
  double coldest_c = std::numeric_limits<double>::infinity();
  double hottest_c = -std::numeric_limits<double>::infinity();
};

Temperatures temperatures_of(const odometer::Map& map) {
  Temperatures of;
  for (std::size_t i = 0; i < map.seen.size(); ++i) {
    if (map.seen[i] == 0) continue;
    const double temp_c = double{map.temp_k[i]} + double{map.reference_c};
    of.coldest_c = std::min(of.coldest_c, temp_c);
    of.hottest_c = std::max(of.hottest_c, temp_c);
  }
  return of;
}

}  // namespace

std::string origin_text(const map_file::StoredMap& stored) {
  return fmt::format("{:.0f} % of the surroundings, {}{}, of {}", 100.0 * map_file::seen_share(stored.map),
                     printable(stored.environment), stored.simulated ? ", SIMULATED" : "",
                     printable(stored.made_utc));
}

std::string map_text(const std::filesystem::path& path, const map_file::StoredMap& stored) {
  std::string text = fmt::format("{}\n", printable(path.string()));
  const auto line = [&](const char* name, const std::string& value) {
    text += fmt::format("  {:<14}{}\n", name, value);
  };
  line("what", fmt::format("a map of the odometer's, {}", stored.simulated ? "SIMULATED" : "of a real rig"));
  line("environment", printable(stored.environment));
  line("rig", printable(stored.rig));
  line("session of", printable(stored.made_utc));
  const odometer::Map::Lens& lens = stored.map.lens;
  line("lens",
       fmt::format("{:.4g} degrees, {}mirrored{}", lens.field_of_view_deg, lens.mirrored ? "" : "not ",
                   lens.is_plain() ? ""
                                   : fmt::format(", distortion {:+.1f} %, tilt {:+.1f} deg, roll {:+.1f} deg",
                                                 100.0 * lens.distortion, lens.tilt_deg, lens.roll_deg)));
  line("rows", std::string(odometer::name_of(stored.map.rows)));
  line("seen", fmt::format("{:.0f} % of all around", 100.0 * map_file::seen_share(stored.map)));
  const Temperatures of = temperatures_of(stored.map);
  if (of.coldest_c <= of.hottest_c)
    line("temperatures", fmt::format("{:.1f} to {:.1f} degC", of.coldest_c, of.hottest_c));
  line("written by", printable(stored.creator));
  return text;
}

nlohmann::json map_json(const std::filesystem::path& path, const map_file::StoredMap& stored) {
  return {{"file", path.string()},
          {"kind", "map"},
          {"simulated", stored.simulated},
          {"environment", printable(stored.environment)},
          {"rig", printable(stored.rig)},
          {"start_time_utc", printable(stored.made_utc)},
          {"field_of_view_deg", stored.map.lens.field_of_view_deg},
          {"mirrored", stored.map.lens.mirrored},
          {"distortion", stored.map.lens.distortion},
          {"tilt_deg", stored.map.lens.tilt_deg},
          {"roll_deg", stored.map.lens.roll_deg},
          {"rows", std::string(odometer::name_of(stored.map.rows))},
          {"seen_share", map_file::seen_share(stored.map)},
          {"creator", printable(stored.creator)}};
}

}  // namespace thermorig::app
