// SPDX-License-Identifier: MIT
#include <array>
#include <utility>

#include "commands.h"
#include "evaluate_parts.h"
#include "plot_files.h"

namespace thermorig::app {

namespace {

[[noreturn]] void refuse_without_paths(const EvaluateOptions& options) {
  const bool model = !options.study && !options.live;
  throw Error(ExitCode::bad_usage, model ? "evaluate needs a model file and sessions" : "which sessions?", "",
              options.study  ? "thermorig evaluate --study recordings -o study"
              : options.live ? "thermorig evaluate --live recordings"
                             : "thermorig evaluate model.onnx recordings");
}

/// What only a study has, and what of it cannot be asked for at once.
void check_study_words(const EvaluateOptions& options) {
  const std::array<std::pair<const char*, bool>, 3> words{{{"--baselines", options.baselines},
                                                           {"--list-jobs", options.list_jobs},
                                                           {"--shard", options.shard.has_value()}}};
  const char* given = nullptr;
  for (const auto& [word, is_given] : words) {
    if (!is_given) continue;
    if (!options.study || options.draw)
      throw Error(ExitCode::bad_usage, std::string(word) + " is for a study that is not only drawn", "",
                  std::string("thermorig evaluate --study recordings -o study ") + word);
    if (given != nullptr)
      throw Error(ExitCode::bad_usage, std::string(given) + " and " + word + " are two questions", "",
                  "run one, then the other");
    given = word;
  }
  if (options.require_complete && (!options.study || !options.draw || options.paths.empty()))
    throw Error(ExitCode::bad_usage, "--require-complete needs to know which jobs the study has", "",
                "give the options of the study, too: thermorig evaluate --study recordings --draw study "
                "--require-complete");
}

/// Before anything long begins.
void check_plots(const EvaluateOptions& options) {
  const char* word = options.live        ? "--live"
                     : options.list_jobs ? "--list-jobs"
                     : options.shard     ? "--shard"
                                         : nullptr;
  if (word != nullptr)
    throw Error(ExitCode::bad_usage, std::string("--plots and ") + word + " do not go together", "",
                options.live ? "--plots is for a model or a study"
                             : "when all parts are done: thermorig evaluate --draw study --plots plots");
  require_plots_possible(options.plots);
}

}  // namespace

ExitCode run(const EvaluateOptions& options) {
  check_study_words(options);
  if (!options.plots.empty()) check_plots(options);
  if (options.require_complete) return draw_complete_study(options);
  if (options.draw) return draw_study(options);
  if (options.live && options.study)
    throw Error(ExitCode::bad_usage, "--live and --study exclude each other", "", "run one, then the other");
  if (options.live && !options.output.empty())
    throw Error(ExitCode::bad_usage, "--output is for reports, and --live only prints", "",
                "leave --output out; --json prints for programs");
  if (options.label && !options.study)
    throw Error(ExitCode::bad_usage, "--label is for a study: a model knows its own label", "",
                "thermorig evaluate --study recordings -o study --label shaft");
  if (options.turned != 1 && (options.live || options.study))
    throw Error(ExitCode::bad_usage, "--turned is for a model on sessions", "",
                "thermorig evaluate model.onnx recordings --turned 8");
  if (options.bound && (options.live || options.study))
    throw Error(ExitCode::bad_usage, "--bound is for a model on sessions", "",
                "thermorig evaluate model.onnx recordings --bound");
  if (options.paths.empty()) refuse_without_paths(options);
  if (options.live) return evaluate_live(options);
  if (options.list_jobs) return list_jobs(options);
  if (options.baselines) return renew_baselines(options);
  return options.study ? run_study(options) : evaluate_model(options);
}

}  // namespace thermorig::app
