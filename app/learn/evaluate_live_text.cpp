// SPDX-License-Identifier: MIT
#include "evaluate_live_text.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "evaluate_numbers.h"
#include "print/number_json.h"
#include "print/output.h"
#include "print/scores_json.h"

namespace thermorig::app {

namespace {

std::string facts_text(const LiveEvaluation& evaluated) {
  const RecordingHeader& header = evaluated.header;
  const LiveModel& model = header.live_model;
  const std::string network = model.name.empty() ? "no network"
                                                 : fmt::format("{} ({}, Nf {}, Nr {})", printable(model.name),
                                                               model.fusion ? "fusion" : "thermal-only",
                                                               model.frames, model.reduction);
  return fmt::format("{}: {} acquisition {}{}, live with {}\n{} frames shown: {} counted, {} excluded\n\n",
                     printable(evaluated.session), printable(header.environment), header.acquisition,
                     header.simulated ? ", SIMULATED rig" : "", network, count_text(evaluated.screen.frames),
                     count_text(evaluated.screen.counted), count_text(evaluated.screen.excluded));
}

std::string screen_text(const live::LiveScores& scores) {
  Table table({"on the screen", ">frames", ">MSE", ">RMSE", ">median*", ">IQR*", ">angle deg", ">deg/min"});
  for (const live::EstimatorScores& rate : scores.estimators) {
    if (rate.frames == 0) continue;
    table.add({printable(rate.name), count_text(rate.frames), mse_text(rate.mse), rate_text(rate.rmse_dps),
               mse_text(rate.recent_median_mse), mse_text(rate.recent_iqr_mse),
               angle_text(rate.angle_error_deg), angle_text(rate.drift_deg_per_min)});
  }
  return table.text() + "RMSE in deg/s; * of the last minute\n\n";
}

std::string gate_text(const live::LiveScores& scores) {
  if (std::isnan(scores.gain_mean)) return "";
  return fmt::format("gate Kg: mean {}{}\n\n", gain_text(scores.gain_mean),
                     scores.gate_collapsed ? "; collapsed at the end" : "");
}

std::string finalised_text(const LiveEvaluation& evaluated) {
  Table table({"finalised labels", ">frames", ">MSE", ">RMSE", ">MSE less the screen's"});
  for (std::size_t i = 0; i < evaluated.finalised_scores.estimators.size(); ++i) {
    const live::EstimatorScores& rate = evaluated.finalised_scores.estimators[i];
    if (rate.frames == 0) continue;
    table.add({printable(rate.name), count_text(rate.frames), mse_text(rate.mse), rate_text(rate.rmse_dps),
               fmt::format("{:+.1e}", rate.mse - evaluated.screen.estimators[i].mse)});
  }
  const live::FinalisedRows& finalised = evaluated.finalised;
  return table.text() + fmt::format(
                            "\nlabels, finalised minus live: mean {:.4f} deg/s, largest {:.4f} deg/s\n"
                            "the finished session has {} windows, {} of the counted ones among them\n",
                            finalised.label_difference_mean_dps, finalised.label_difference_max_dps,
                            count_text(finalised.windows), count_text(finalised.counted_in_both));
}

nlohmann::json evaluated_model_json(const LiveModel& model) {
  if (model.name.empty()) return {};
  return {{"name", model.name},     {"hash", model.hash},           {"frames", model.frames},
          {"fusion", model.fusion}, {"reduction", model.reduction}, {"simulated", model.simulated}};
}

nlohmann::json finalised_json(const LiveEvaluation& evaluated) {
  const live::FinalisedRows& finalised = evaluated.finalised;
  return {{"compared", finalised.compared},
          {"windows", finalised.windows},
          {"counted_in_both", finalised.counted_in_both},
          {"label_difference_mean_dps", number_json(finalised.label_difference_mean_dps)},
          {"label_difference_max_dps", number_json(finalised.label_difference_max_dps)},
          {"scores", scores_json(evaluated.finalised_scores)}};
}

}  // namespace

std::string live_text(const LiveEvaluation& evaluated) {
  return facts_text(evaluated) + screen_text(evaluated.screen) + gate_text(evaluated.screen) +
         finalised_text(evaluated);
}

nlohmann::json live_json(const LiveEvaluation& evaluated) {
  const RecordingHeader& header = evaluated.header;
  return {{"event", "live"},
          {"session", evaluated.session},
          {"environment", header.environment},
          {"acquisition", header.acquisition},
          {"simulated", header.simulated},
          {"model", evaluated_model_json(header.live_model)},
          {"frames", evaluated.screen.frames},
          {"scores", scores_json(evaluated.screen)},
          {"finalised", finalised_json(evaluated)}};
}

}  // namespace thermorig::app
