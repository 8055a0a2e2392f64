// SPDX-License-Identifier: MIT
#include "evaluate_model_text.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "evaluate_numbers.h"
#include "output.h"
#include "thermorig/report/report.h"

namespace thermorig::app {

namespace {

using study::Errors;
using study::Estimator;

std::size_t index_of(Estimator estimator) {
  return static_cast<std::size_t>(estimator);
}

std::string simulated_text(bool simulated) {
  return simulated ? ", SIMULATED rig" : "";
}

std::string facts_text(const std::string& name, const model::Model& model) {
  const network::Shape& shape = model.weights.shape;
  const model::Provenance& origin = model.provenance;
  std::string text =
      fmt::format("{}: {}, Nf {}, Nr {}, {} weights, {} multiply-adds a window\n", printable(name),
                  shape.fusion ? "fusion" : "thermal-only", shape.frames, shape.reduction,
                  count_text(network::weight_count(shape)), count_text(network::multiply_adds(shape)));
  if (origin.training.empty()) return text + "trained on: not stated\n";
  return text + fmt::format("trained on {} acquisition{}, preset {}, seed {}, epoch {} of {}{}\n",
                            origin.training.size(), origin.training.size() == 1 ? "" : "s",
                            printable(origin.preset), origin.seed, origin.epoch_kept, origin.epochs,
                            simulated_text(origin.simulated));
}

std::string tested_text(const ModelEvaluation& evaluated) {
  return fmt::format("tested on {} acquisition{}{}\n\n", evaluated.evaluation.names.size(),
                     evaluated.evaluation.names.size() == 1 ? "" : "s",
                     simulated_text(evaluated.evaluation.simulated));
}

std::string errors_text(const study::Evaluation& evaluation) {
  Table table(
      {"estimator", ">windows", ">MSE", ">RMSE deg/s", ">median", ">95 %", "> >30 deg/s", ">mean error"});
  for (const Estimator estimator : study::all_estimators) {
    const Errors& errors = evaluation.errors[index_of(estimator)];
    table.add({study::name_of(estimator), count_text(errors.windows), mse_text(errors.mse),
               rate_text(errors.rmse_dps), rate_text(errors.median_dps), rate_text(errors.p95_dps),
               percent_text(errors.outlier_share), rate_text(errors.bias_dps)});
  }
  return table.text() + "\n";
}

/// MSE beside RMSE: one column an estimator.
std::string environments_text(const std::vector<study::EnvironmentErrors>& environments) {
  Table table({"environment", ">acquisitions", ">thermal-only", ">fusion", ">gyro", ">gyro, bias removed"});
  for (const study::EnvironmentErrors& environment : environments) {
    std::vector<std::string> row{environment.name, std::to_string(environment.acquisitions)};
    for (const Errors& errors : environment.errors)
      row.push_back(fmt::format("{} ({})", mse_text(errors.mse), rate_text(errors.rmse_dps)));
    table.add(row);
  }
  return "MSE (RMSE deg/s) by environment\n" + table.text() + "\n";
}

std::string gate_text(const study::GainStatistics& gain) {
  if (gain.windows() == 0) return "";
  return fmt::format("gate Kg: mean {}, deviation {}, median {}; below 0.02 in {}, above 0.98 in {}\n\n",
                     gain_text(gain.mean), gain_text(gain.deviation), gain_text(gain.median),
                     percent_text(gain.below_002), percent_text(gain.above_098));
}

std::string angles_text(const study::Evaluation& evaluation) {
  Table table(
      {"drift of the angle, deg/min", ">thermal-only", ">fusion", ">gyro", ">gyro, bias removed", ">over"});
  for (std::size_t i = 0; i < evaluation.angles.size(); ++i) {
    std::vector<std::string> row{evaluation.names[i]};
    for (const double drift : evaluation.angles[i].drift_deg_per_min) row.push_back(angle_text(drift));
    row.push_back(duration_text(evaluation.angles[i].integrated_s));
    table.add(row);
  }
  return table.text();
}

/// Keys as in the report.
nlohmann::json json_of(const Errors& errors) {
  return {{"windows", errors.windows},   {"mse", errors.mse},
          {"rmse_dps", errors.rmse_dps}, {"median_dps", errors.median_dps},
          {"p95_dps", errors.p95_dps},   {"outlier_share", errors.outlier_share},
          {"bias_dps", errors.bias_dps}};
}

nlohmann::json json_of(const study::EnvironmentErrors& environment) {
  nlohmann::json errors;
  for (const Estimator estimator : study::all_estimators)
    errors[study::field_name_of(estimator)] = json_of(environment.errors[index_of(estimator)]);
  return {{"name", environment.name}, {"acquisitions", environment.acquisitions}, {"errors", errors}};
}

}  // namespace

std::string model_text(const std::string& name, const model::Model& model, const ModelEvaluation& evaluated) {
  std::string text = facts_text(name, model) + tested_text(evaluated) + errors_text(evaluated.evaluation);
  if (evaluated.evaluation.environments.size() > 1)
    text += environments_text(evaluated.evaluation.environments);
  text += gate_text(evaluated.evaluation.gain) + angles_text(evaluated.evaluation);
  if (!evaluated.warnings.empty()) text += "\n";
  for (const std::string& warning : evaluated.warnings) text += "warning: " + printable(warning) + "\n";
  return text;
}

nlohmann::json model_json(const model::Model& model, const ModelEvaluation& evaluated) {
  nlohmann::json object = nlohmann::json::parse(report::evaluation_json(model, evaluated.evaluation));
  object["event"] = "summary";
  object["exit_code"] = 0;
  object["simulated"] = evaluated.evaluation.simulated;
  object["warnings"] = evaluated.warnings;
  nlohmann::json& environments = object["environments"] = nlohmann::json::array();
  for (const study::EnvironmentErrors& environment : evaluated.evaluation.environments)
    environments.push_back(json_of(environment));
  return object;
}

}  // namespace thermorig::app
