// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "thermorig/learning/report/report.h"

namespace thermorig::app {

/// Throws Error(storage) if there is anything in the folder that is to take plots: nothing is overwritten,
/// and whoever asked for them learns it before anything long begins. The folder need not exist.
void require_no_plots(const std::filesystem::path& folder);

/// Writes the files, and of each figure PDF and PNG, too, where rsvg-convert is installed; else it says so.
/// Throws Error(storage) if a file cannot be written, Error(failed) if rsvg-convert fails.
void write_plots(const std::filesystem::path& folder, const std::vector<report::PlotFile>& files);

}  // namespace thermorig::app
