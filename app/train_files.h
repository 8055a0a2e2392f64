// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "options.h"

namespace thermorig::app {

/// The run folder that was asked for, or the one beside the model: "model.onnx" has "model.run".
std::filesystem::path run_folder_of(const TrainOptions& options);

/// Throws Error(bad_usage) if a model is there already. A run that goes on may replace the one that it wrote
/// itself: the same bytes as `written`.
void require_free(const std::filesystem::path& output, const std::filesystem::path& written);

}  // namespace thermorig::app
