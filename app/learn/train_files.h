// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "options.h"

namespace thermorig::app {

/// The run folder that was asked for, or the one beside the model: "model.onnx" has "model.run".
std::filesystem::path run_folder_of(const TrainOptions& options);

/// May a model be written there? Not over a file, unless it is the one that a run wrote that now goes on: the
/// same bytes as `written`. Throws Error(bad_usage) for a folder.
bool is_free(const std::filesystem::path& output, const std::filesystem::path& written);

/// Throws Error(bad_usage) if it may not.
void require_free(const std::filesystem::path& output, const std::filesystem::path& written);

}  // namespace thermorig::app
