// SPDX-License-Identifier: MIT
#include "header_check.h"

#include <algorithm>
#include <set>

#include "thermorig/storage/recording_header/header_json.h"
#include "thermorig/storage/recording_header/profile_fields.h"

namespace thermorig::recording_header {

namespace {

constexpr int most_frames = 100;  // of any network's window

bool is_within(double value, double least, double most) {
  return value >= least && value <= most;
}

/// 1 to 32 of a-z, 0-9, '-' and '_'.
bool is_estimator_word(const std::string& word) {
  const auto is_allowed = [](char one) {
    return (one >= 'a' && one <= 'z') || (one >= '0' && one <= '9') || one == '-' || one == '_';
  };
  return !word.empty() && word.size() <= 32 && std::all_of(word.begin(), word.end(), is_allowed);
}

/// Its label scale divides, its frames are a window of rows; the rest is only told.
bool live_model_is_sound(const LiveModel& model) {
  return is_within(model.label_scale_dps, 1e-3, 1e6) && model.frames >= 0 && model.frames <= most_frames &&
         model.reduction >= 0;
}

/// Names are words, each once, and each estimator has few values.
bool estimators_are_sound(const std::vector<EstimatorColumn>& estimators) {
  std::set<std::string> names;
  const auto is_sound = [&](const EstimatorColumn& column) {
    return is_estimator_word(column.name) && names.insert(column.name).second &&
           column.values.size() <= most_estimate_values &&
           std::all_of(column.values.begin(), column.values.end(), is_estimator_word);
  };
  return estimators.size() <= most_estimators && std::all_of(estimators.begin(), estimators.end(), is_sound);
}

}  // namespace

bool is_environment_name(const std::string& name) {
  const auto allowed = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; };
  return !name.empty() && name.size() <= 32 && std::all_of(name.begin(), name.end(), allowed);
}

std::optional<std::string> problem_of(const RecordingHeader& header) {
  if (!is_environment_name(header.environment))
    return "the environment's name is not made of 1 to 32 of a-z, 0-9 and '-'";
  if (!header.licence.empty() && !is_line(header.licence))
    return "the licence of the data is not a line of up to 1000 bytes of UTF-8";
  for (const std::string& said : {header.operator_name, header.place, header.note})
    if (!said.empty() && !is_line(said))
      return "its operator, place or note is not a line of up to 1000 bytes of UTF-8";
  if (!is_reference(header.time_reference)) return "it counts from a time that no host's clock shows";
  if (header.acquisition < 0 || header.frames_per_leg < 0)
    return "the acquisition number or the frames of a leg are negative";
  if (const auto problem = problem_of(header.profile)) return "the profile's " + problem->text();
  if (!live_model_is_sound(header.live_model)) return "the live model's label scale or shape is out of range";
  if (!estimators_are_sound(header.estimators)) return "the names of its estimators are not sound";
  return std::nullopt;
}

}  // namespace thermorig::recording_header
