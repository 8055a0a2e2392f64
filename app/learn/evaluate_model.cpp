// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "evaluate_numbers.h"
#include "evaluate_parts.h"
#include "frame_memory.h"
#include "general_model.h"
#include "plot_files.h"
#include "print/output.h"
#include "print/terminal_width.h"
#include "report_files.h"
#include "session_data.h"
#include "thermorig/estimators/table.h"
#include "thermorig/learning/report/report.h"
#include "thermorig/learning/study/evaluation.h"
#include "thermorig/network/model/model.h"

namespace thermorig::app {

namespace {

/// A model on sessions, and what is to be said about it.
struct ModelEvaluation {
  study::Evaluation evaluation;
  std::vector<std::string> warnings;
  bool labelled_by_gyro = false;  // one of the sessions at least: its rig had no servo
};

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
  return fmt::format("{}(fusion: expected RMSE beside a gyro that is off by {:g} deg/s)\n\n", table.text(),
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

using network::Acquisition;

std::vector<study::JudgedWindow> judged_by(const model::Model& model,
                                           const std::vector<Acquisition>& acquisitions, int turned) {
  const std::vector<network::Window> windows =
      network::find_windows(acquisitions, model.weights.shape.frames);
  if (windows.empty())
    throw Error(ExitCode::bad_usage,
                fmt::format("the sessions have no window of {} valid frames", model.weights.shape.frames), "",
                "thermorig inspect --check says what is wrong with them");
  return study::judged_windows(model, acquisitions, windows, turned);
}

/// Tested acquisitions that the model knows already.
std::vector<std::string> seen_in_training(const model::Model& model,
                                          const std::vector<Acquisition>& acquisitions) {
  std::vector<std::string> trained_on;
  const auto add = [&](const std::vector<model::Provenance::Data>& data) {
    for (const model::Provenance::Data& known : data)
      for (const Acquisition& acquisition : acquisitions)
        if (!known.hash.empty() && known.hash == acquisition.hash) trained_on.push_back(acquisition.name);
  };
  add(model.provenance.training);
  add(model.provenance.held_out);
  return trained_on;
}

/// Those that need no network, and that a fusion ought to beat and does not.
std::vector<std::string> better_baselines(const ModelEvaluation& evaluated) {
  std::vector<std::string> better;
  if (evaluated.labelled_by_gyro) return better;  // a gyro is not better for being its own label
  const study::Evaluation& evaluation = evaluated.evaluation;
  for (const std::string& name : study::baselines())
    if (evaluation.errors[name].mse < evaluation.errors[study::fusion_name].mse) better.push_back(name);
  return better;
}

/// Bounds were wanted, and there is none.
std::vector<std::string> without_bounds(const std::vector<Acquisition>& acquisitions) {
  std::vector<std::string> names;
  for (const Acquisition& acquisition : acquisitions)
    if (acquisition.bound_frames > 0 &&
        std::none_of(acquisition.bound_dps.begin(), acquisition.bound_dps.end(),
                     [](float bound_dps) { return bound_dps > 0.0F; }))
      names.push_back(acquisition.name);
  return names;
}

/// Whose camera is none that the model has learnt, as far as both know theirs.
std::vector<std::string> with_another_view(const model::Model& model,
                                           const std::vector<Acquisition>& acquisitions) {
  std::vector<std::string> names;
  const auto& view = model.provenance.view;
  for (const Acquisition& acquisition : acquisitions)
    if (view && acquisition.view && !view->fits(*acquisition.view)) names.push_back(acquisition.name);
  return names;
}

std::vector<std::string> warnings_of(const model::Model& model, const ModelEvaluation& evaluated,
                                     const std::vector<Acquisition>& acquisitions) {
  std::vector<std::string> warnings;
  const std::vector<std::string> trained_on = seen_in_training(model, acquisitions);
  if (!trained_on.empty())
    warnings.push_back(
        fmt::format("the model was trained on, or chosen by, {} of the tested acquisitions: {}",
                    trained_on.size(), fmt::join(trained_on, ", ")));
  if (study::collapsed(evaluated.evaluation.gain))
    warnings.push_back(collapsed_text(evaluated.evaluation.gain.mean));
  const std::vector<std::string> better = better_baselines(evaluated);
  if (!better.empty())
    warnings.push_back(fmt::format("a lower MSE than {}, without a network: {}", study::fusion_name,
                                   fmt::join(better, ", ")));
  const std::vector<std::string> other_view = with_another_view(model, acquisitions);
  if (!other_view.empty())
    warnings.push_back(
        fmt::format("the model has learnt another lens, other frames or another orientation than "
                    "those of {}",
                    fmt::join(other_view, ", ")));
  const std::vector<std::string> unbounded = without_bounds(acquisitions);
  if (!unbounded.empty())
    warnings.push_back(
        fmt::format("no bound for {}: the odometer built no map there (it needs "
                    "a gyro, structure all around, and half a minute of turning)",
                    fmt::join(unbounded, ", ")));
  return warnings;
}

void write_model_report(const std::filesystem::path& folder, const model::Model& model,
                        const study::Evaluation& evaluation) {
  write_report(folder, {.markdown = report::evaluation_markdown(model, evaluation),
                        .json = report::evaluation_json(model, evaluation),
                        .html = report::evaluation_html(model, evaluation)});
}

}  // namespace

ExitCode evaluate_model(const EvaluateOptions& options) {
  NamedModel named = named_model(options.model);
  const model::Model& model = named.model;
  FrameMemory memory(options.frame_memory, options.output.empty() ? options.model : options.output);
  dataset::Acquisitions data =
      memory.read(session_options(options), model.weights.shape.pixels() * sizeof(float));
  const auto all_of_them = [](const Acquisition&) { return true; };
  memory.run_estimators(data, options.json, all_of_them, options.bound ? model.weights.shape.frames : 0);
  const std::vector<Acquisition>& acquisitions = data.acquisitions;
  if (const auto& view = acquisitions.front().view; options.model == "general" && view)
    named = named_model(options.model, view->width_deg);  // of the same shape
  ModelEvaluation evaluated;
  evaluated.evaluation = study::evaluate(judged_by(model, acquisitions, options.turned), acquisitions,
                                         {.label_scale_dps = double{model.scaling.label_scale_dps}});
  evaluated.labelled_by_gyro =
      std::any_of(acquisitions.begin(), acquisitions.end(),
                  [](const Acquisition& acquisition) { return acquisition.is_labelled_by_gyro; });
  evaluated.warnings = warnings_of(model, evaluated, acquisitions);
  if (!options.output.empty()) write_model_report(options.output, model, evaluated.evaluation);
  if (!options.plots.empty())
    write_plots(options.plots, report::evaluation_plots(model, evaluated.evaluation));
  if (options.json) {
    nlohmann::json object = model_json(model, evaluated);
    add_choice_to(object, data);
    memory.add_to(object);
    print_json(object);
  } else {
    print("{}", model_text(named.name, model, evaluated));
  }
  return ExitCode::ok;
}

}  // namespace thermorig::app
