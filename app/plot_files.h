// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "thermorig/learning/report/report.h"

namespace thermorig::app {

/// To be called before anything long begins. Throws Error(storage) if there is anything in the folder that is
/// to take plots, as nothing is overwritten, and Error(failed) if this program draws no charts. The folder
/// need not exist.
void require_plots_possible(const std::filesystem::path& folder);

/// Writes the files, and of each figure PDF and PNG, too, where rsvg-convert is installed; else it says so.
/// Throws Error(storage) if a file cannot be written, Error(failed) if rsvg-convert fails.
void write_plots(const std::filesystem::path& folder, const std::vector<report::PlotFile>& files);

}  // namespace thermorig::app
