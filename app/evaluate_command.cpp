// SPDX-License-Identifier: MIT
#include "commands.h"
#include "evaluate_parts.h"

namespace thermorig::app {

ExitCode run(const EvaluateOptions& options) {
  if (options.draw) return draw_study(options);
  if (options.paths.empty())
    throw Error(ExitCode::bad_usage,
                options.study ? "which sessions?" : "evaluate needs a model file and sessions", "",
                options.study ? "thermorig evaluate --study recordings -o study"
                              : "thermorig evaluate model.onnx recordings");
  return options.study ? run_study(options) : evaluate_model(options);
}

}  // namespace thermorig::app
