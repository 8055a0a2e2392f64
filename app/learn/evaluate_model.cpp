// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "evaluate_model_text.h"
#include "evaluate_numbers.h"
#include "evaluate_parts.h"
#include "frame_memory.h"
#include "general_model.h"
#include "plot_files.h"
#include "print/output.h"
#include "report_files.h"
#include "session_data.h"
#include "thermorig/learning/report/report.h"

namespace thermorig::app {

namespace {

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
    warnings.push_back(fmt::format("without a network, {} {} a lower MSE than {}", fmt::join(better, ", "),
                                   better.size() == 1 ? "has" : "have", study::fusion_name));
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
