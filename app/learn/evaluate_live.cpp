// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "evaluate_live_text.h"
#include "evaluate_parts.h"
#include "print/output.h"
#include "session_data.h"
#include "thermorig/learning/dataset/dataset.h"
#include "thermorig/storage/session/annotations.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::app {

namespace {

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
