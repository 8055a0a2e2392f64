// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "evaluate_model_text.h"
#include "evaluate_numbers.h"
#include "evaluate_parts.h"
#include "existing_file.h"
#include "output.h"
#include "report_files.h"
#include "session_data.h"
#include "thermorig/report/report.h"

namespace thermorig::app {

namespace {

using windows::Acquisition;

std::vector<training::WindowEstimate> estimates_of(const model::Model& model,
                                                   const std::vector<Acquisition>& acquisitions) {
  const std::vector<windows::Window> windows =
      windows::find_windows(acquisitions, model.weights.shape.frames);
  if (windows.empty())
    throw Error(ExitCode::bad_usage,
                fmt::format("the sessions have no window of {} valid frames", model.weights.shape.frames), "",
                "thermorig inspect --check says what is wrong with them");
  return training::predict(model, acquisitions, windows);
}

study::EvaluationConfig config_of(const model::Model& model) {
  study::EvaluationConfig config;
  config.label_scale_dps = double{model.scaling.label_scale_dps};
  config.fusion = model.weights.shape.fusion;
  return config;
}

std::vector<EnvironmentErrors> by_environment(const std::vector<training::WindowEstimate>& estimates,
                                              const std::vector<Acquisition>& acquisitions,
                                              const study::EvaluationConfig& config) {
  std::map<std::string, std::vector<training::WindowEstimate>> parts;
  for (const training::WindowEstimate& estimate : estimates)
    parts[acquisitions[estimate.window.acquisition].environment].push_back(estimate);
  std::vector<EnvironmentErrors> environments;
  for (const auto& [name, part] : parts) {
    const auto count = std::count_if(acquisitions.begin(), acquisitions.end(),
                                     [&](const Acquisition& a) { return a.environment == name; });
    environments.push_back(
        {name, static_cast<std::size_t>(count), study::evaluate(part, acquisitions, config).errors});
  }
  return environments;
}

/// Tested acquisitions that the model knows already.
std::vector<std::string> seen_in_training(const model::Model& model,
                                          const std::vector<Acquisition>& acquisitions) {
  std::vector<std::string> seen;
  const auto add = [&](const std::vector<model::Provenance::Data>& data) {
    for (const model::Provenance::Data& known : data)
      for (const Acquisition& acquisition : acquisitions)
        if (!known.hash.empty() && known.hash == acquisition.hash) seen.push_back(acquisition.name);
  };
  add(model.provenance.training);
  add(model.provenance.held_out);
  return seen;
}

std::vector<std::string> warnings_of(const model::Model& model, const ModelEvaluation& evaluated,
                                     const std::vector<Acquisition>& acquisitions) {
  std::vector<std::string> warnings;
  const std::vector<std::string> seen = seen_in_training(model, acquisitions);
  if (!seen.empty())
    warnings.push_back(
        fmt::format("the model was trained on, or chosen by, {} of the tested acquisitions: {}", seen.size(),
                    fmt::join(seen, ", ")));
  if (study::collapsed(evaluated.evaluation.gain))
    warnings.push_back(
        fmt::format("the gate has collapsed: Kg is below 0.02 in {} and above 0.98 in {} of the windows",
                    percent_text(evaluated.evaluation.gain.below_002),
                    percent_text(evaluated.evaluation.gain.above_098)));
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
  require_existing(options.model);
  const model::Model model = model::read_model(options.model);
  const std::vector<Acquisition> acquisitions = read_data(options.paths, options.json);
  const std::vector<training::WindowEstimate> estimates = estimates_of(model, acquisitions);
  const study::EvaluationConfig config = config_of(model);
  ModelEvaluation evaluated;
  evaluated.evaluation = study::evaluate(estimates, acquisitions, config);
  evaluated.environments = by_environment(estimates, acquisitions, config);
  evaluated.simulated = any_simulated(acquisitions);
  evaluated.warnings = warnings_of(model, evaluated, acquisitions);
  if (!options.output.empty()) write_model_report(options.output, model, evaluated.evaluation);
  if (options.json)
    print_json(model_json(model, evaluated));
  else
    fmt::print("{}", model_text(options.model.filename().string(), model, evaluated));
  return ExitCode::ok;
}

}  // namespace thermorig::app
