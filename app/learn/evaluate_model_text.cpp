// SPDX-License-Identifier: MIT
#include "evaluate_model_text.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "evaluate_numbers.h"
#include "print/output.h"
#include "print/terminal_width.h"
#include "thermorig/estimators/table.h"
#include "thermorig/learning/report/report.h"

namespace thermorig::app {

namespace {

using study::Errors;

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
  if (origin.made_windows > 0)
    text += fmt::format("trained on {} windows of MADE-UP rooms\n", count_text(origin.made_windows));
  if (!origin.begun_from.empty()) text += fmt::format("begun from {}\n", printable(origin.begun_from));
  if (origin.training.empty()) return origin.made_windows > 0 ? text : text + "trained on: not stated\n";
  return text + fmt::format("trained on {} of {} acquisition{}, preset {}, seed {}, epoch {} of {}{}\n",
                            origin.label ? column_of(*origin.label) : "a label that is not stated",
                            origin.training.size(), origin.training.size() == 1 ? "" : "s",
                            printable(origin.preset), origin.seed, origin.epoch_kept, origin.epochs,
                            simulated_text(origin.simulated));
}

std::string tested_text(const ModelEvaluation& evaluated) {
  return fmt::format("tested on {} acquisition{}{}\n\n", evaluated.evaluation.names.size(),
                     evaluated.evaluation.names.size() == 1 ? "" : "s",
                     simulated_text(evaluated.evaluation.simulated));
}

/// Labels that are the gyro's say nothing of who sees the gyro.
std::vector<std::string> judged_names(bool by_gyro) {
  const auto all = study::all_estimators();
  std::vector<std::string> names(all.begin(), all.end());
  if (by_gyro)
    std::erase_if(names, [](const std::string& name) { return estimators::entry(name).inputs.gyro; });
  return names;
}

std::string errors_text(const study::PerEstimator<Errors>& by_estimator, const char* truth, bool by_gyro) {
  Table table({truth, ">windows", ">MSE", ">RMSE", ">median", ">95 %", "> >30", ">mean"});
  for (const std::string& name : judged_names(by_gyro)) {
    const Errors& errors = by_estimator[name];
    table.add({name, count_text(errors.windows), mse_text(errors.mse), rate_text(errors.rmse_dps),
               rate_text(errors.median_dps), rate_text(errors.p95_dps), percent_text(errors.outlier_share),
               rate_text(errors.mean_error_dps)});
  }
  return table.text() + "\n";
}

/// A table with a column an estimator, between these.
Table estimator_table(std::vector<std::string> header, const std::vector<std::string>& last, bool by_gyro) {
  for (const std::string& name : judged_names(by_gyro)) header.push_back(">" + name);
  header.insert(header.end(), last.begin(), last.end());
  return Table(header);
}

std::string environments_text(const std::vector<study::EnvironmentErrors>& environments, bool by_gyro) {
  Table table = estimator_table({"environment", ">sessions"}, {}, by_gyro);
  for (const study::EnvironmentErrors& environment : environments) {
    std::vector<std::string> row{environment.name, std::to_string(environment.acquisitions)};
    for (const std::string& name : judged_names(by_gyro))
      row.push_back(rate_text(environment.errors[name].rmse_dps));
    table.add(row);
  }
  return "RMSE by environment\n" + table.wrapped(terminal_width()) + "\n";
}

std::string multiple_text(double multiple) {
  return std::isfinite(multiple) ? fmt::format("{:.2f}", multiple) : "-";
}

std::string bounds_text(const std::optional<study::BoundErrors>& bounds) {
  if (!bounds) return "";
  Table table({"in units of the bound", ">median error", ">RMSE, bound below 2"});
  for (const std::string& name : study::all_estimators())
    table.add({name, multiple_text(bounds->median[name]), multiple_text(bounds->well_told_rmse[name])});
  return fmt::format("Cramer-Rao bound of the images: median {} deg/s over {} windows, below 2 deg/s in {}\n",
                     rate_text(bounds->median_dps), count_text(bounds->windows),
                     count_text(bounds->well_told)) +
         table.text() + "\n";
}

std::string gate_text(const study::GainStatistics& gain) {
  if (gain.windows() == 0) return "";
  return fmt::format("Kg: mean {}, deviation {}, median {}; below 0.02: {}, above 0.98: {}\n\n",
                     gain_text(gain.mean), gain_text(gain.deviation), gain_text(gain.median),
                     percent_text(gain.below_002), percent_text(gain.above_098));
}

std::string sigma_text(const study::Evaluation& evaluation) {
  if (!evaluation.sigma) return "";
  Table table({"sigma that Kg states", ">median", ">in one", ">in two", ">Kg 5 %", ">95 %", ">fusion"});
  const auto add = [&](const std::string& name, const study::GateSigma& sigma) {
    table.add({name, rate_text(sigma.median_dps), percent_text(sigma.within_one),
               percent_text(sigma.within_two), gain_text(sigma.gain_p05), gain_text(sigma.gain_p95),
               rate_text(sigma.fusion_rmse_dps)});
  };
  for (const study::EnvironmentErrors& environment : evaluation.environments)
    if (environment.sigma) add(printable(environment.name), *environment.sigma);
  add("all", *evaluation.sigma);
  return fmt::format("{}(fusion: in expectation over a gyro that is off by {:g} deg/s)\n\n", table.text(),
                     study::expected_gyro_dps);
}

std::string angles_text(const study::Evaluation& evaluation, bool by_gyro) {
  Table table = estimator_table({"drift, deg/min"}, {">over"}, by_gyro);
  for (std::size_t i = 0; i < evaluation.angles.size(); ++i) {
    std::vector<std::string> row{evaluation.names[i]};
    for (const std::string& name : judged_names(by_gyro))
      row.push_back(angle_text(evaluation.angles[i].drift_deg_per_min[name]));
    row.push_back(duration_text(evaluation.angles[i].integrated_s));
    table.add(row);
  }
  return table.wrapped(terminal_width());
}

}  // namespace

std::string model_text(const std::string& name, const model::Model& model, const ModelEvaluation& evaluated) {
  const bool by_gyro = evaluated.labelled_by_gyro;
  std::string text =
      facts_text(name, model) + tested_text(evaluated) +
      errors_text(evaluated.evaluation.errors, by_gyro ? "against the gyro" : "against the command", by_gyro);
  if (by_gyro)
    text += "left out: estimators that see the gyro\n\n";
  else
    text += errors_text(evaluated.evaluation.shaft_errors, "against the shaft", by_gyro);
  text += "RMSE, median, 95 %, mean error: deg/s; > 30: share of errors above 30 deg/s\n\n";
  if (evaluated.evaluation.environments.size() > 1)
    text += environments_text(evaluated.evaluation.environments, by_gyro);
  text += bounds_text(evaluated.evaluation.bounds);
  text += gate_text(evaluated.evaluation.gain) + sigma_text(evaluated.evaluation) +
          angles_text(evaluated.evaluation, by_gyro);
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
  return object;
}

}  // namespace thermorig::app
