// SPDX-License-Identifier: MIT
#include "preflight_json.h"

#include <nlohmann/json.hpp>

namespace thermorig::app {

namespace {

nlohmann::json violations_json(const std::vector<rig::PreflightViolation>& found) {
  nlohmann::json list = nlohmann::json::array();
  for (const rig::PreflightViolation& violation : found)
    list.push_back({{"name", violation.name},
                    {"device", name_of(violation.device)},
                    {"figure", violation.figure},
                    {"limit", violation.limit},
                    {"advice", violation.advice}});
  return list;
}

nlohmann::json devices_json(const rig::PreflightFacts& facts) {
  nlohmann::json devices = nlohmann::json::object();
  for (const Device device : all_devices) {
    const auto& stream = facts.streams[device];
    devices[std::string(name_of(device))] =
        !stream ? nlohmann::json()
                : nlohmann::json{
                      {"messages", stream->messages},           {"rate_hz", stream->rate_hz},
                      {"nominal_hz", stream->nominal_hz},       {"lost_share", stream->lost_share},
                      {"damaged_share", stream->damaged_share}, {"uncertainty_s", stream->uncertainty_s}};
  }
  return devices;
}

}  // namespace

nlohmann::json preflight_json(const std::optional<rig::PreflightReport>& report) {
  if (!report) return {};
  const rig::PreflightFacts& facts = report->facts;
  nlohmann::json object{{"passed", report->passed()},
                        {"span_s", facts.span_s},
                        {"violations", violations_json(report->violations)},
                        {"warnings", violations_json(report->warnings)},
                        {"devices", devices_json(facts)},
                        {"images", nlohmann::json()},
                        {"rest", nlohmann::json()},
                        {"answers", nlohmann::json()}};
  if (facts.images)
    object["images"] = {{"even_fresh_share", facts.images->even_fresh_share},
                        {"odd_fresh_share", facts.images->odd_fresh_share},
                        {"repeated_share", facts.images->repeated_share},
                        {"lost_half_share", facts.images->lost_half_share},
                        {"sensor_drift_c_per_min", facts.images->sensor_drift_c_per_min}};
  if (facts.rest)
    object["rest"] = {{"mean_dps", facts.rest->mean_dps},
                      {"noise_dps", facts.rest->noise_dps},
                      {"swing_dps", facts.rest->swing_dps},
                      {"zeroes_itself", facts.rest->zeroes_itself}};
  if (facts.answers)
    object["answers"] = {{"pings", facts.answers->pings},
                         {"answered", facts.answers->answered},
                         {"round_trip_s", facts.answers->round_trip_s},
                         {"firmware", facts.answers->firmware}};
  return object;
}

}  // namespace thermorig::app
