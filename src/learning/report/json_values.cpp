// SPDX-License-Identifier: MIT
#include "json_values.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "gain_figures.h"

namespace thermorig::report {

using nlohmann::json;

json errors_json(const study::PerEstimator<study::Errors>& errors) {
  json by_name;
  for (const std::string& name : study::all_estimators()) {
    const study::Errors& one = errors[name];
    by_name[name] = {{"windows", one.windows},   {"mse", one.mse},
                     {"rmse_dps", one.rmse_dps}, {"median_dps", one.median_dps},
                     {"p95_dps", one.p95_dps},   {"outlier_share", one.outlier_share},
                     {"bias_dps", one.bias_dps}};
  }
  return by_name;
}

json bounds_json(const study::BoundErrors& bounds) {
  json by_name;
  for (const std::string& name : study::all_estimators())
    by_name[name] = {{"median", bounds.median[name]}, {"rmse_below_2_dps", bounds.well_told_rmse[name]}};
  return {{"windows", bounds.windows},
          {"windows_below_2_dps", bounds.well_told},
          {"median_dps", bounds.median_dps},
          {"multiples", by_name}};
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
  return {
      {"windows", gain.windows()},   {"histogram", gain.histogram}, {"mean", gain.mean},
      {"deviation", gain.deviation}, {"median", gain.median},       {"below_002", gain.below_002},
      {"above_098", gain.above_098}, {"peak", peak_of(gain)},       {"collapsed", study::collapsed(gain)}};
}

json speeds_json(const std::vector<study::SpeedErrors>& speeds) {
  json array = json::array();
  for (const study::SpeedErrors& speed : speeds) {
    json mse;
    for (const std::string& name : study::all_estimators()) mse[name] = speed.mse[name];
    array.push_back({{"rate_dps", speed.rate_dps}, {"windows", speed.windows}, {"mse", mse}});
  }
  return array;
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
