// SPDX-License-Identifier: MIT
#include "scores_json.h"

#include <nlohmann/json.hpp>

#include "number_json.h"

namespace thermorig::app {

namespace {

nlohmann::json estimator_json(const live::EstimatorScores& scores) {
  return {{"frames", scores.frames},
          {"mse", number_json(scores.mse)},
          {"rmse_dps", number_json(scores.rmse_dps)},
          {"recent", scores.recent},
          {"recent_median_mse", number_json(scores.recent_median_mse)},
          {"recent_iqr_mse", number_json(scores.recent_iqr_mse)},
          {"angle_error_deg", number_json(scores.angle_error_deg)},
          {"drift_deg_per_min", number_json(scores.drift_deg_per_min)}};
}

}  // namespace

nlohmann::json scores_json(const live::LiveScores& scores) {
  nlohmann::json estimators = nlohmann::json::object();
  for (const live::EstimatorScores& one : scores.estimators) estimators[one.name] = estimator_json(one);
  return {{"counted", scores.counted},
          {"excluded", scores.excluded},
          {"integrated_s", number_json(scores.integrated_s)},
          {"gain_mean", number_json(scores.gain_mean)},
          {"gain_histogram", scores.gain_histogram},
          {"gate_collapsed", scores.gate_collapsed},
          {"estimators", std::move(estimators)}};
}

}  // namespace thermorig::app
