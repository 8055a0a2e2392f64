// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "options.h"
#include "thermorig/learning/dataset/dataset.h"

namespace thermorig::app {

/// Which sessions are read, and how that is told.
struct SessionOptions {
  const std::vector<std::filesystem::path>& paths;  // files, or folders that hold them
  bool accept_bad = false;                          // a verdict "bad" is no reason against one
  bool json = false;                                // nothing is printed
  Label label = Label::commanded;
  bool packs = false;  // pixels, as soon as they are read
};

/// Reads the sessions that the paths name, telling on a terminal how far it is. Says which were left out,
/// since they were recorded for calibrations, or are bad and were found in a folder; and which are bad, but
/// were accepted. Throws as dataset does, Error(check_failed) for a bad one that is named itself or where no
/// other is left, Error(bad_usage) where all are for calibrations.
dataset::Acquisitions read_data(const SessionOptions& options);

/// Runs the estimators that need no network over the sessions that are wanted, telling on a terminal how
/// far it is. Throws as dataset::run_estimators_over().
void run_estimators(dataset::Acquisitions& data, bool json, const dataset::IsWanted& is_wanted,
                    int bound_frames = 0);

/// Is the file one of these paths, and not only in a folder that one of them is?
bool is_named(const std::filesystem::path& file, const std::vector<std::filesystem::path>& paths);

/// Names sessions that were found in a folder and left out, and why.
void tell_left_out(const std::vector<dataset::BadSession>& bad);

/// Throws Error(check_failed), naming the first of the bad sessions, unless they are accepted.
void require_good(const std::vector<dataset::BadSession>& bad, bool accepted);

/// For programs: adds `left_out` and `bad`, lists of files.
void add_choice_to(nlohmann::json& object, const dataset::Acquisitions& data);

/// What `evaluate` is told of its sessions. Throws Error(bad_usage) for a label that there is not.
SessionOptions session_options(const EvaluateOptions& options);

/// Is any of them of the simulated rig?
bool any_simulated(const std::vector<network::Acquisition>& acquisitions);

}  // namespace thermorig::app
