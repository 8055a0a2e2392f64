// SPDX-License-Identifier: MIT
#include "commands.h"
#include "evaluate_parts.h"

namespace thermorig::app {

namespace {

[[noreturn]] void refuse_without_paths(const EvaluateOptions& options) {
  const bool model = !options.study && !options.live;
  throw Error(ExitCode::bad_usage, model ? "evaluate needs a model file and sessions" : "which sessions?", "",
              options.study  ? "thermorig evaluate --study recordings -o study"
              : options.live ? "thermorig evaluate --live recordings"
                             : "thermorig evaluate model.onnx recordings");
}

}  // namespace

ExitCode run(const EvaluateOptions& options) {
  if (options.draw) return draw_study(options);
  if (options.live && options.study)
    throw Error(ExitCode::bad_usage, "--live and --study are two questions", "", "ask one after the other");
  if (options.bound && (options.live || options.study))
    throw Error(ExitCode::bad_usage, "--bound is of a model on sessions", "",
                "thermorig evaluate model.onnx recordings --bound");
  if (options.baselines && !options.study)
    throw Error(ExitCode::bad_usage, "--baselines are those of a study", "",
                "thermorig evaluate --study recordings -o study --baselines");
  if (options.paths.empty()) refuse_without_paths(options);
  if (options.live) return evaluate_live(options);
  if (options.baselines) return renew_baselines(options);
  return options.study ? run_study(options) : evaluate_model(options);
}

}  // namespace thermorig::app
