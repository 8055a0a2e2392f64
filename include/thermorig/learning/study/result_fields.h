// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "thermorig/learning/study/study.h"

namespace thermorig::study {

// The fields of a study's figures by their names in JSON: one list for a result file, both ways, and for the
// reports. `fields(key, value)` writes or reads one; `fields.has(version)` asks whether the file is of that
// version of the format or a later one.

inline constexpr int with_label_and_shaft = 3, with_settled_angles = 4;

template <typename Value, typename Of>
concept Is = std::is_same_v<std::remove_const_t<Value>, Of>;

template <typename Fields>
void fields_of(const Fields& fields, Is<Job> auto& job) {
  fields("engine", job.engine);
  fields("frames", job.frames);
  fields("reduction", job.reduction);
  fields("fusion", job.fusion);
  fields("seed", job.seed);
  fields("preset", job.preset);
  if (fields.has(with_label_and_shaft)) fields("label", job.label);
  fields("settings", job.settings);
  fields("epochs", job.epochs);
  fields("history", job.history);
  fields("test", job.test);
  fields("test_hash", job.test_hash);
  fields("data_hash", job.data_hash);
}

template <typename Fields>
void fields_of(const Fields& fields, Is<Errors> auto& errors) {
  fields("windows", errors.windows);
  fields("mse", errors.mse);
  fields("rmse_dps", errors.rmse_dps);
  fields("median_dps", errors.median_dps);
  fields("p95_dps", errors.p95_dps);
  fields("outlier_share", errors.outlier_share);
  fields("mean_error_dps", errors.mean_error_dps);
}

template <typename Fields>
void fields_of(const Fields& fields, Is<SpeedErrors> auto& speed) {
  fields("rate_dps", speed.rate_dps);
  fields("windows", speed.windows);
  fields("mse", speed.mse);
}

template <typename Fields>
void fields_of(const Fields& fields, Is<GainStatistics> auto& gain) {
  fields("histogram", gain.histogram);
  fields("mean", gain.mean);
  fields("deviation", gain.deviation);
  fields("median", gain.median);
  fields("below_002", gain.below_002);
  fields("above_098", gain.above_098);
}

template <typename Fields>
void fields_of(const Fields& fields, Is<AngleTrack> auto& track) {
  fields("integrated_s", track.integrated_s);
  fields("time_s", track.time_s);
  fields("commanded_deg", track.commanded_deg);
  fields("error_deg", track.error_deg);
  fields("drift_deg_per_min", track.drift_deg_per_min);
  fields("worst_deg", track.worst_deg);
  if (!fields.has(with_settled_angles)) return;
  fields("settled_drift_deg_per_min", track.settled_drift_deg_per_min);
  fields("settled_worst_deg", track.settled_worst_deg);
}

template <typename Fields>
void fields_of(const Fields& fields, Is<Evaluation> auto& evaluation) {
  fields("errors", evaluation.errors);
  if (fields.has(with_label_and_shaft)) fields("shaft_errors", evaluation.shaft_errors);
  fields("speeds", evaluation.speeds);
  fields("gain", evaluation.gain);
  fields("angles", evaluation.angles);
  fields("names", evaluation.names);
}

template <typename Fields>
void fields_of(const Fields& fields, Is<JobResult> auto& result) {
  fields("job", result.job);
  fields("evaluation", result.evaluation);
  fields("simulated", result.simulated);
  fields("label_scale_dps", result.label_scale_dps);
  fields("training_windows", result.training_windows);
  fields("training_mse", result.training_mse);
  fields("epoch_kept", result.epoch_kept);
  fields("weights", result.weights);
  fields("multiply_adds", result.multiply_adds);
  fields("seconds", result.seconds);
  fields("instruction_set", result.instruction_set);
}

enum class OverEstimators { as_list, by_name };

/// Writes fields into `object`; what is not finite becomes null in its text.
class FieldWriter {
 public:
  FieldWriter(nlohmann::json& object, OverEstimators form) : object_(object), form_(form) {}

  bool has(int) const { return true; }

  template <typename Value>
  void operator()(const char* key, const Value& value) const {
    object_[key] = json_of(value);
  }

  template <typename Value>
  nlohmann::json json_of(const Value& value) const {
    if constexpr (std::is_constructible_v<nlohmann::json, const Value&>) {
      return value;
    } else {
      nlohmann::json object = nlohmann::json::object();
      fields_of(FieldWriter(object, form_), value);
      return object;
    }
  }
  nlohmann::json json_of(Label label) const { return name_of(label); }
  template <typename Struct>
  nlohmann::json json_of(const std::vector<Struct>& values) const {
    nlohmann::json list = nlohmann::json::array();
    for (const Struct& value : values) list.push_back(json_of(value));
    return list;
  }
  template <typename Value>
  nlohmann::json json_of(const PerEstimator<Value>& values) const {
    if (form_ == OverEstimators::as_list) return json_of(values.values());
    nlohmann::json object = nlohmann::json::object();
    for (const std::string& name : all_estimators()) object[name] = json_of(values[name]);
    return object;
  }

 private:
  nlohmann::json& object_;
  OverEstimators form_;
};

}  // namespace thermorig::study
