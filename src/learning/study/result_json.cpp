// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "fingerprint.h"
#include "thermorig/core/error.h"
#include "thermorig/learning/study/study.h"

namespace thermorig::study {

namespace {

/// Reads the fields of an object in a result file. Everything that is missing, of another type or out of
/// range is refused with Error(not_a_session), by its full name. Numbers may be null, which is NaN.
class Fields {
 public:
  /// `object` must outlive this. `prefix`: name of the object with a dot at its end, empty for the whole
  /// file.
  Fields(const nlohmann::json& object, std::string where, std::string prefix);

  [[noreturn]] void refuse(const std::string& field, const std::string& what) const;

  int integer(const char* field, int low, int high) const;
  std::uint64_t count(const char* field) const;  // at most 2^53
  std::uint64_t seed(const char* field) const;   // any 64 bits
  double number(const char* field) const;
  double number(const char* field, double low, double high) const;  // or unknown
  double magnitude(const char* field) const;                        // at least 0, or unknown
  bool truth(const char* field) const;
  std::string text(const char* field) const;

  std::vector<double> numbers(const char* field) const;
  std::vector<double> magnitudes(const char* field) const;
  std::vector<std::vector<double>> rows(const char* field, std::size_t count) const;
  std::vector<std::string> texts(const char* field) const;
  Fields object(const char* field) const;
  std::vector<Fields> objects(const char* field) const;

  template <std::size_t N>
  std::array<std::uint64_t, N> counts(const char* field) const {
    const nlohmann::json& values = list(field);
    if (values.size() != N) refuse(field, "has another length");
    std::array<std::uint64_t, N> array{};
    for (std::size_t i = 0; i < N; ++i) array[i] = count_of(values[i], field);
    return array;
  }

 private:
  const nlohmann::json& at(const char* field) const;
  const nlohmann::json& list(const char* field) const;
  double within(double number, double low, double high, const char* field) const;
  double number_of(const nlohmann::json& value, const char* field) const;
  std::uint64_t count_of(const nlohmann::json& value, const char* field) const;

  const nlohmann::json* object_;
  std::string where_;
  std::string prefix_;
};

using nlohmann::json;

constexpr std::size_t max_text = 4'000'000;  // a result is below 20 kB; a model tested on hundreds is not one
constexpr int max_depth = 8;
constexpr std::uint64_t max_count = std::uint64_t{1} << 53;  // window counts add up without overflow

[[noreturn]] void refuse_file(const std::string& what, const std::string& where) {
  throw Error(ExitCode::not_a_session, "this is no sound result of a study: " + what, where,
              "delete it and run the study again: only this job is then repeated");
}

/// One hostile text to JSON: an object, not too long, not nested deeper than a result is. Throws
/// Error(not_a_session).
json parsed(const std::string& text, const std::string& where) {
  if (text.size() > max_text) refuse_file("it is far too long", where);
  const auto not_too_deep = [](int depth, json::parse_event_t, json&) {
    return depth <= max_depth;  // what lies deeper is dropped while it is read
  };
  json object = json::parse(text, not_too_deep, false);
  if (object.is_discarded() || !object.is_object()) refuse_file("it is not a JSON object", where);
  return object;
}

Fields::Fields(const json& object, std::string where, std::string prefix)
    : object_(&object), where_(std::move(where)), prefix_(std::move(prefix)) {
  if (!object.is_object()) refuse_file(fmt::format("{} is no object", prefix_), where_);
}

void Fields::refuse(const std::string& field, const std::string& what) const {
  refuse_file(fmt::format("{}{} {}", prefix_, field, what), where_);
}

const json& Fields::at(const char* field) const {
  const auto found = object_->find(field);
  if (found == object_->end()) refuse(field, "is missing");
  return *found;
}

const json& Fields::list(const char* field) const {
  const json& value = at(field);
  if (!value.is_array()) refuse(field, "is no list");
  return value;
}

double Fields::number_of(const json& value, const char* field) const {
  if (value.is_null()) return std::numeric_limits<double>::quiet_NaN();
  if (!value.is_number()) refuse(field, "is no number");
  const double number = value.get<double>();
  if (!std::isfinite(number)) refuse(field, "is out of range");
  return number;
}

std::uint64_t Fields::count_of(const json& value, const char* field) const {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > max_count) refuse(field, "is no count");
  return value.get<std::uint64_t>();
}

int Fields::integer(const char* field, int low, int high) const {
  const json& value = at(field);
  if (!value.is_number_integer()) refuse(field, "is no whole number");
  const std::int64_t number = value.get<std::int64_t>();
  if (number < low || number > high) refuse(field, fmt::format("is not within {}..{}", low, high));
  return static_cast<int>(number);
}

std::uint64_t Fields::count(const char* field) const {
  return count_of(at(field), field);
}

std::uint64_t Fields::seed(const char* field) const {
  const json& value = at(field);
  if (!value.is_number_unsigned()) refuse(field, "is no seed");
  return value.get<std::uint64_t>();
}

double Fields::number(const char* field) const {
  return number_of(at(field), field);
}

double Fields::within(double number, double low, double high, const char* field) const {
  if (number < low || number > high) refuse(field, fmt::format("is {}, which cannot be", number));
  return number;
}

double Fields::number(const char* field, double low, double high) const {
  return within(number(field), low, high, field);
}

double Fields::magnitude(const char* field) const {
  return number(field, 0.0, std::numeric_limits<double>::max());
}

std::vector<double> Fields::magnitudes(const char* field) const {
  std::vector<double> magnitudes = numbers(field);
  for (const double value : magnitudes) within(value, 0.0, std::numeric_limits<double>::max(), field);
  return magnitudes;
}

bool Fields::truth(const char* field) const {
  const json& value = at(field);
  if (!value.is_boolean()) refuse(field, "is neither true nor false");
  return value.get<bool>();
}

std::string Fields::text(const char* field) const {
  const json& value = at(field);
  if (!value.is_string()) refuse(field, "is no text");
  return value.get<std::string>();
}

std::vector<double> Fields::numbers(const char* field) const {
  std::vector<double> numbers;
  for (const json& value : list(field)) numbers.push_back(number_of(value, field));
  return numbers;
}

std::vector<std::vector<double>> Fields::rows(const char* field, std::size_t count) const {
  const json& values = list(field);
  if (values.size() != count) refuse(field, "has another length");
  std::vector<std::vector<double>> rows(count);
  for (std::size_t i = 0; i < count; ++i) {
    if (!values[i].is_array()) refuse(field, "is no list of lists");
    for (const json& value : values[i]) rows[i].push_back(number_of(value, field));
  }
  return rows;
}

std::vector<std::string> Fields::texts(const char* field) const {
  std::vector<std::string> texts;
  for (const json& value : list(field)) {
    if (!value.is_string()) refuse(field, "holds what is no text");
    texts.push_back(value.get<std::string>());
  }
  return texts;
}

Fields Fields::object(const char* field) const {
  return {at(field), where_, fmt::format("{}{}.", prefix_, field)};
}

std::vector<Fields> Fields::objects(const char* field) const {
  std::vector<Fields> objects;
  for (const json& value : list(field))
    objects.emplace_back(value, where_, fmt::format("{}{}[{}].", prefix_, field, objects.size()));
  return objects;
}

using nlohmann::json;

constexpr const char* format_name = "thermorig study result";
constexpr int format_version = 5;  // 1 had other names of estimators
constexpr int with_label = 3;      // and errors against the shaft
constexpr int with_settled = 4;    // angles from 30 s on
constexpr int with_sum = 5;

constexpr std::array<std::pair<std::string_view, std::string_view>, 3> names_before_version_2{
    {{"thermal", thermal_name}, {"fusion", fusion_name}, {"gyro_unbiased", "gyro-rest"}}};

/// The estimators of a file, by their place in its lists.
class EstimatorAxis {
 public:
  explicit EstimatorAxis(std::vector<std::string> names) : names_(std::move(names)) {
    for (std::string& name : names_)
      for (const auto& [before, now] : names_before_version_2)
        if (name == before) name = now;
  }

  std::size_t size() const { return names_.size(); }

  /// What the file says of those that there are today. `values`: one a name.
  template <typename Value>
  void place(const std::vector<Value>& values, PerEstimator<Value>& placed) const {
    for (const std::string& name : all_estimators()) {
      const auto found = std::find(names_.begin(), names_.end(), name);
      if (found != names_.end()) placed[name] = values[static_cast<std::size_t>(found - names_.begin())];
    }
  }

  void place(const Fields& fields, const char* field, PerEstimator<double>& placed,
             bool magnitudes = false) const {
    const std::vector<double> values = magnitudes ? fields.magnitudes(field) : fields.numbers(field);
    if (values.size() != size()) fields.refuse(field, "has another length");
    place(values, placed);
  }

 private:
  std::vector<std::string> names_;
};

json json_of(const Job& job) {
  return {{"engine", job.engine},        {"frames", job.frames},     {"reduction", job.reduction},
          {"fusion", job.fusion},        {"seed", job.seed},         {"preset", job.preset},
          {"label", name_of(job.label)}, {"settings", job.settings}, {"epochs", job.epochs},
          {"history", job.history},      {"test", job.test},         {"test_hash", job.test_hash},
          {"data_hash", job.data_hash}};
}

/// Before version 3 there was no choice.
Label label_from(const Fields& fields, int version) {
  if (version < with_label) return Label::commanded;
  const auto label = find_label(fields.text("label"));
  if (!label) fields.refuse("label", "is not known here");
  return *label;
}

Job job_from(const Fields& fields, int version) {
  Job job;
  job.engine = fields.integer("engine", 0, 1'000'000);
  job.frames = fields.integer("frames", network::min_frames, network::max_frames);
  job.reduction = fields.integer("reduction", network::min_reduction, network::max_reduction);
  job.fusion = fields.truth("fusion");
  job.seed = fields.seed("seed");
  job.preset = fields.text("preset");
  job.label = label_from(fields, version);
  job.settings = fields.text("settings");
  job.epochs = fields.integer("epochs", 1, 1'000'000);
  job.history = fields.integer("history", 0, 1'000'000);
  job.test = fields.text("test");
  job.test_hash = fields.text("test_hash");
  job.data_hash = fields.text("data_hash");
  return job;
}

json json_of(const Errors& errors) {
  return {{"windows", errors.windows},        {"mse", errors.mse},
          {"rmse_dps", errors.rmse_dps},      {"median_dps", errors.median_dps},
          {"p95_dps", errors.p95_dps},        {"outlier_share", errors.outlier_share},
          {"mean_error_dps", errors.bias_dps}};
}

Errors errors_from(const Fields& fields) {
  Errors errors;
  errors.windows = fields.count("windows");
  errors.mse = fields.magnitude("mse");
  errors.rmse_dps = fields.magnitude("rmse_dps");
  errors.median_dps = fields.magnitude("median_dps");
  errors.p95_dps = fields.magnitude("p95_dps");
  errors.outlier_share = fields.number("outlier_share", 0.0, 1.0);
  errors.bias_dps = fields.number("mean_error_dps");
  return errors;
}

json json_of(const SpeedErrors& speed) {
  return {{"rate_dps", speed.rate_dps}, {"windows", speed.windows}, {"mse", speed.mse.values()}};
}

SpeedErrors speed_from(const Fields& fields, const EstimatorAxis& axis) {
  SpeedErrors speed{fields.number("rate_dps"), fields.count("windows")};
  axis.place(fields, "mse", speed.mse, true);
  return speed;
}

json json_of(const GainStatistics& gain) {
  return {{"histogram", gain.histogram}, {"mean", gain.mean},           {"deviation", gain.deviation},
          {"median", gain.median},       {"below_002", gain.below_002}, {"above_098", gain.above_098}};
}

GainStatistics gain_from(const Fields& fields) {
  GainStatistics gain;
  gain.histogram = fields.counts<GainStatistics::bins>("histogram");
  gain.mean = fields.number("mean", 0.0, 1.0);
  gain.deviation = fields.magnitude("deviation");
  gain.median = fields.number("median", 0.0, 1.0);
  gain.below_002 = fields.number("below_002", 0.0, 1.0);
  gain.above_098 = fields.number("above_098", 0.0, 1.0);
  return gain;
}

json json_of(const AngleTrack& track) {
  return {{"integrated_s", track.integrated_s},
          {"time_s", track.time_s},
          {"commanded_deg", track.commanded_deg},
          {"error_deg", track.error_deg.values()},
          {"drift_deg_per_min", track.drift_deg_per_min.values()},
          {"worst_deg", track.worst_deg.values()},
          {"settled_drift_deg_per_min", track.settled_drift_deg_per_min.values()},
          {"settled_worst_deg", track.settled_worst_deg.values()}};
}

AngleTrack track_from(const Fields& fields, const EstimatorAxis& axis, int version) {
  AngleTrack track;
  track.integrated_s = fields.magnitude("integrated_s");
  track.time_s = fields.magnitudes("time_s");
  track.commanded_deg = fields.numbers("commanded_deg");
  if (track.commanded_deg.size() != track.time_s.size()) fields.refuse("commanded_deg", "has another length");
  const std::vector<std::vector<double>> lines = fields.rows("error_deg", axis.size());
  for (const std::vector<double>& line : lines)
    if (!line.empty() && line.size() != track.time_s.size()) fields.refuse("error_deg", "has another length");
  axis.place(lines, track.error_deg);
  axis.place(fields, "drift_deg_per_min", track.drift_deg_per_min);
  axis.place(fields, "worst_deg", track.worst_deg);
  if (version < with_settled) return track;
  axis.place(fields, "settled_drift_deg_per_min", track.settled_drift_deg_per_min);
  axis.place(fields, "settled_worst_deg", track.settled_worst_deg);
  return track;
}

template <typename Part>
json list_of(const std::vector<Part>& parts) {
  json list = json::array();
  for (const Part& part : parts) list.push_back(json_of(part));
  return list;
}

json json_of(const Evaluation& evaluation) {
  return {{"errors", list_of(evaluation.errors.values())},
          {"shaft_errors", list_of(evaluation.shaft_errors.values())},
          {"speeds", list_of(evaluation.speeds)},
          {"gain", json_of(evaluation.gain)},
          {"angles", list_of(evaluation.angles)},
          {"names", evaluation.names}};
}

void place_errors(const Fields& fields, const char* field, const EstimatorAxis& axis,
                  PerEstimator<Errors>& placed) {
  std::vector<Errors> errors;
  for (const Fields& one : fields.objects(field)) errors.push_back(errors_from(one));
  if (errors.size() != axis.size()) fields.refuse(field, "has another length");
  axis.place(errors, placed);
}

Evaluation evaluation_from(const Fields& fields, const EstimatorAxis& axis, int version) {
  Evaluation evaluation;
  place_errors(fields, "errors", axis, evaluation.errors);
  if (version >= with_label) place_errors(fields, "shaft_errors", axis, evaluation.shaft_errors);
  for (const Fields& speed : fields.objects("speeds")) evaluation.speeds.push_back(speed_from(speed, axis));
  evaluation.gain = gain_from(fields.object("gain"));
  for (const Fields& track : fields.objects("angles"))
    evaluation.angles.push_back(track_from(track, axis, version));
  evaluation.names = fields.texts("names");
  if (evaluation.names.size() != evaluation.angles.size()) fields.refuse("names", "has another length");
  return evaluation;
}

std::string text_of(const json& object) {
  return object.dump(-1, ' ', false, json::error_handler_t::replace);
}

/// SHA-256 of all other fields, as they are written.
void require_sum(const Fields& fields, json object) {
  const std::string sum = fields.text("sum");
  object.erase("sum");
  if (fingerprint_of(text_of(object)) != sum) fields.refuse("sum", "is that of other values");
}

}  // namespace

std::string to_json(const JobResult& result) {
  json object{{"format", format_name},
              {"version", format_version},
              {"estimators", all_estimators()},
              {"job", json_of(result.job)},
              {"evaluation", json_of(result.evaluation)},
              {"simulated", result.simulated},
              {"label_scale_dps", result.label_scale_dps},
              {"training_windows", result.training_windows},
              {"training_mse", result.training_mse},
              {"epoch_kept", result.epoch_kept},
              {"weights", result.weights},
              {"multiply_adds", result.multiply_adds},
              {"seconds", result.seconds},
              {"instruction_set", result.instruction_set}};
  object = json::parse(text_of(object));  // as a reader will have it
  object["sum"] = fingerprint_of(text_of(object));
  return text_of(object) + "\n";
}

JobResult result_from_json(const std::string& text, const std::string& where) {
  const json object = parsed(text, where);
  const Fields fields(object, where, "");
  if (fields.text("format") != format_name) fields.refuse("format", "is another");
  const int version = fields.integer("version", 1, 1'000'000);
  if (version > format_version) fields.refuse("version", "is not known here");
  JobResult result;
  result.job = job_from(fields.object("job"), version);
  const EstimatorAxis axis(fields.texts("estimators"));
  result.evaluation = evaluation_from(fields.object("evaluation"), axis, version);
  result.simulated = result.evaluation.simulated = fields.truth("simulated");
  result.label_scale_dps = fields.magnitude("label_scale_dps");
  result.training_windows = fields.count("training_windows");
  result.training_mse = fields.magnitudes("training_mse");
  result.epoch_kept = fields.integer("epoch_kept", 0, 1'000'000);
  result.weights = fields.count("weights");
  result.multiply_adds = fields.count("multiply_adds");
  result.seconds = fields.magnitude("seconds");
  result.instruction_set = fields.text("instruction_set");
  if (version >= with_sum) require_sum(fields, object);
  return result;
}

}  // namespace thermorig::study
