// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "options.h"
#include "thermorig/learning/study/study.h"

namespace thermorig::app {

/// The jobs of the study that the options describe. Throws Error(bad_usage) as study::jobs_of() does.
std::vector<study::Job> jobs_of_study(const EvaluateOptions& options,
                                      const std::vector<network::Acquisition>& acquisitions);

/// Throws Error(bad_usage) where no folder is named that a study keeps its results in.
void require_results_folder(const EvaluateOptions& options);

/// Lists the jobs that have no result. Throws Error(check_failed) if there are any.
void require_complete(const std::vector<study::Job>& jobs, const std::filesystem::path& folder, bool json);

}  // namespace thermorig::app
