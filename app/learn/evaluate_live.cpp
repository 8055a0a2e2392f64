// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>

#include <algorithm>
#include <optional>
#include <string>

#include "evaluate_numbers.h"
#include "evaluate_parts.h"
#include "print/number_json.h"
#include "print/output.h"
#include "print/scores_json.h"
#include "session_data.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/estimators/live/finalised_rows.h"
#include "thermorig/estimators/live/scores.h"
#include "thermorig/learning/dataset/dataset.h"
#include "thermorig/storage/session/annotations.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::app {

namespace {

/// A live run that was kept: the screen's last figures, and what they become with the finalised labels.
struct LiveEvaluation {
  std::string session;  // path
  RecordingHeader header;
  live::LiveScores screen;
  live::FinalisedRows finalised;
  live::LiveScores finalised_scores;
};

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

namespace fs = std::filesystem;

live::LiveScores scores_of(const std::vector<EstimateRow>& rows, const RecordingHeader& header) {
  live::Scorer scorer(header.estimators, header.live_model.label_scale_dps);
  for (const EstimateRow& row : rows) scorer.add(row);
  return scorer.scores();
}

LiveEvaluation evaluate(const session::Session& session, const fs::path& path) {
  const RawRecording& raw = session.raw;
  const network::Acquisition finished = dataset::acquisition_of(session, path.string());
  LiveEvaluation evaluated{.session = path.string(), .header = raw.header};
  const session::Place place = session::place_of(session);
  evaluated.header.environment = place.environment;
  evaluated.header.acquisition = place.acquisition;
  evaluated.screen = scores_of(raw.estimates, raw.header);
  evaluated.finalised = live::finalised_rows(
      raw.estimates, finished, std::max(1, raw.header.live_model.frames), session.frame_period_s);
  evaluated.finalised_scores = scores_of(evaluated.finalised.rows, raw.header);
  return evaluated;
}

[[noreturn]] void refuse_evaluation(const std::string& what, const std::string& where) {
  throw Error(ExitCode::bad_usage, what, where,
              "make one with thermorig live --record, or hold a model against it: thermorig evaluate "
              "model.onnx SESSION");
}

void tell(const LiveEvaluation& evaluated, bool first, bool json) {
  if (json)
    print_json(live_json(evaluated));
  else
    print("{}{}", first ? "" : "\n", live_text(evaluated));
}

}  // namespace

ExitCode evaluate_live(const EvaluateOptions& options) {
  std::size_t told = 0;
  dataset::Acquisitions left_out;
  for (const fs::path& file : dataset::find_sessions(options.paths)) {
    const session::Session session = session::read_session(file);
    const bool named = is_named(file, options.paths);
    if (session.raw.estimates.empty()) {
      if (named) refuse_evaluation("the session has no /estimates: it is not of a live run", file.string());
      continue;  // found in a folder, beside others
    }
    if (!session.raw.header.profile.servo.is_there()) {
      if (named)
        refuse_evaluation("its rig has no servo: nothing was commanded that could be scored against",
                          file.string());
      continue;
    }
    if (auto bad = dataset::bad_session(session, file); bad && !options.accept_bad) {
      if (named) require_good({*bad}, false);
      left_out.left_out.push_back(std::move(*bad));
      continue;
    }
    tell(evaluate(session, file), told == 0, options.json);
    ++told;
  }
  if (told == 0) require_good(left_out.left_out, false);
  if (told == 0) refuse_evaluation("none of the sessions has /estimates: none is of a live run", "");
  if (!options.json) {
    tell_left_out(left_out.left_out);
    return ExitCode::ok;
  }
  nlohmann::json summary{{"event", "summary"}, {"exit_code", 0}, {"sessions", told}};
  add_choice_to(summary, left_out);
  print_json(summary);
  return ExitCode::ok;
}

}  // namespace thermorig::app
