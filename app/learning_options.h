// SPDX-License-Identifier: MIT
#pragma once

#include "options.h"

namespace CLI {
class App;
}

namespace thermorig::app {

// The words of the commands that learn; each in a file of its own (CLI11 compiles slowly).
/// --nf and --nr.
void add_window_shape(CLI::App& command, std::optional<int>& frames, std::optional<int>& reduction);
/// --memory.
void add_frame_memory(CLI::App& command, FrameOptions& options);
void add_train(CLI::App& root, TrainOptions& options);
void add_evaluate(CLI::App& root, EvaluateOptions& options);
void add_export(CLI::App& root, ExportOptions& options);

}  // namespace thermorig::app
