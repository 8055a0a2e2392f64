// SPDX-License-Identifier: MIT
#include "json_values.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "gain_figures.h"
#include "thermorig/learning/study/result_fields.h"

namespace thermorig::report {

using nlohmann::json;

namespace {

template <typename Value>
json by_name(const Value& value) {
  json unused;
  return study::FieldWriter(unused, study::OverEstimators::by_name).json_of(value);
}

}  // namespace

json errors_json(const study::PerEstimator<study::Errors>& errors) {
  return by_name(errors);
}

json bounds_json(const study::BoundErrors& bounds) {
  json multiples;
  for (const std::string& name : study::all_estimators())
    multiples[name] = {{"median", bounds.median[name]}, {"rmse_below_2_dps", bounds.well_told_rmse[name]}};
  return {{"windows", bounds.windows},
          {"windows_below_2_dps", bounds.well_told},
          {"median_dps", bounds.median_dps},
          {"multiples", multiples}};
}

json sigma_json(const study::GateSigma& sigma) {
  return {{"windows", sigma.windows},
          {"median_dps", sigma.median_dps},
          {"within_one", sigma.within_one},
          {"within_two", sigma.within_two},
          {"gain_p05", sigma.gain_p05},
          {"gain_p95", sigma.gain_p95},
          {"fusion_rmse_beside_10_dps", sigma.fusion_rmse_dps}};
}

json gain_json(const study::GainStatistics& gain) {
  if (gain.windows() == 0) return nullptr;
  json object = by_name(gain);
  object["windows"] = gain.windows();
  object["peak"] = peak_of(gain);
  object["collapsed"] = study::collapsed(gain);
  return object;
}

json speeds_json(const std::vector<study::SpeedErrors>& speeds) {
  return by_name(speeds);
}

json drift_json(const study::AngleTrack& track) {
  json drift;
  for (const std::string& name : study::all_estimators())
    drift[name] = {{"drift_deg_per_min", track.drift_deg_per_min[name]},
                   {"worst_deg", track.worst_deg[name]},
                   {"settled_drift_deg_per_min", track.settled_drift_deg_per_min[name]},
                   {"settled_worst_deg", track.settled_worst_deg[name]}};
  return {{"integrated_s", track.integrated_s}, {"estimators", drift}};
}

json drawn(double value) {
  if (!std::isfinite(value)) return nullptr;
  return std::strtod(fmt::format("{:.4g}", value).c_str(), nullptr);
}

json drawn(const std::vector<double>& values) {
  json array = json::array();
  for (const double value : values) array.push_back(drawn(value));
  return array;
}

std::string json_text(const json& value) {
  return value.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

}  // namespace thermorig::report
