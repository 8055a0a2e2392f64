// SPDX-License-Identifier: MIT
#pragma once

#include "options.h"
#include "thermorig/core/error.h"

namespace thermorig::app {

// What `evaluate` can be asked for.

ExitCode evaluate_model(const EvaluateOptions& options);
ExitCode evaluate_live(const EvaluateOptions& options);
ExitCode run_study(const EvaluateOptions& options);
ExitCode list_jobs(const EvaluateOptions& options);  // of a study; runs none
ExitCode draw_study(const EvaluateOptions& options);
ExitCode draw_complete_study(const EvaluateOptions& options);  // else it is refused
ExitCode renew_baselines(const EvaluateOptions& options);      // of a study's results; trains nothing

}  // namespace thermorig::app
