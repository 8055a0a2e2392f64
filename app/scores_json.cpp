// SPDX-License-Identifier: MIT
#include "scores_json.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace thermorig::app {

namespace {

using nlohmann::json;

json number(double value) {
  return std::isfinite(value) ? json(value) : json();
}

json scores_json(const live::RateScores& scores) {
  return {{"frames", scores.frames},
          {"mse", number(scores.mse)},
          {"rmse_dps", number(scores.rmse_dps)},
          {"recent", scores.recent},
          {"recent_median_mse", number(scores.recent_median_mse)},
          {"recent_iqr_mse", number(scores.recent_iqr_mse)},
          {"angle_error_deg", number(scores.angle_error_deg)},
          {"drift_deg_per_min", number(scores.drift_deg_per_min)}};
}

}  // namespace

json scores_json(const live::LiveScores& scores) {
  const auto of = [&](live::Rate rate) { return scores_json(scores.rates[static_cast<std::size_t>(rate)]); };
  return {{"counted", scores.counted},
          {"apart", scores.apart},
          {"integrated_s", number(scores.integrated_s)},
          {"gain_mean", number(scores.gain_mean)},
          {"gain_histogram", scores.gain_histogram},
          {"gate_collapsed", scores.gate_collapsed},
          {"thermal", of(live::Rate::thermal)},
          {"gyro", of(live::Rate::gyro)},
          {"fusion", of(live::Rate::fusion)}};
}

}  // namespace thermorig::app
