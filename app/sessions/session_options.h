// SPDX-License-Identifier: MIT
#pragma once

#include "options.h"

namespace CLI {
class App;
}

namespace thermorig::app {

// The commands that keep sessions in order. Each adds its words, and writes what it parses into `options`.
void add_list(CLI::App& root, ListOptions& options);
void add_annotate(CLI::App& root, AnnotateOptions& options);
void add_dataset(CLI::App& root, DatasetOptions& options);

}  // namespace thermorig::app
