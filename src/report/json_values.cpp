// SPDX-License-Identifier: MIT
#include "json_values.h"

#include "gain_figures.h"
#include "sections.h"

namespace thermorig::report {

using nlohmann::json;

json errors_json(const study::Errors& errors) {
  return {{"windows", errors.windows},   {"mse", errors.mse},
          {"rmse_dps", errors.rmse_dps}, {"median_dps", errors.median_dps},
          {"p95_dps", errors.p95_dps},   {"outlier_share", errors.outlier_share},
          {"bias_dps", errors.bias_dps}};
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
    for (const study::Estimator estimator : study::all_estimators)
      mse[series_key(estimator)] = speed.mse[static_cast<std::size_t>(estimator)];
    array.push_back({{"rate_dps", speed.rate_dps}, {"windows", speed.windows}, {"mse", mse}});
  }
  return array;
}

json drift_json(const study::AngleTrack& track) {
  json drift;
  for (const study::Estimator estimator : study::all_estimators) {
    const auto index = static_cast<std::size_t>(estimator);
    drift[series_key(estimator)] = {{"drift_deg_per_min", track.drift_deg_per_min[index]},
                                    {"worst_deg", track.worst_deg[index]}};
  }
  return {{"integrated_s", track.integrated_s}, {"estimators", drift}};
}

std::string json_text(const json& value) {
  return value.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

}  // namespace thermorig::report
