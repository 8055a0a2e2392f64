// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "options.h"

namespace CLI {
class App;
class Option;
class Validator;
}  // namespace CLI

namespace thermorig::app {

// Words that several commands share.

/// The groups of their help.
inline constexpr const char* rig_group = "Rig";
inline constexpr const char* simulated_rig_group = "Simulated rig";

void add_json(CLI::App& command, bool& json);

/// Refuses what has a minus: read as a number without a sign it would be one near 2^64.
CLI::Validator not_negative();
/// Refuses what is not a number from `least` to `most`. (CLI::Range takes NaN for a number of any range.)
CLI::Validator within(double least, double most);

/// --sync: when what is recorded has to be on the disk.
void add_sync(CLI::App& command, int& period_ms);
/// --replug-patience: how long a device is waited for that goes.
void add_replug(CLI::App& command, double& patience_s);
/// A word that must be one of `names`; for any other the nearest is named.
CLI::Validator known_name(std::vector<std::string> names);
/// The same; help lists the names.
CLI::Validator one_of(std::vector<std::string> names);
void add_simulated_parts(CLI::App& command, SimulatedParts& parts);
/// --simulated[=SEED]. Parsing throws Error(bad_usage) unless it is a whole number from 0 to 2^64 - 1.
void add_seed(CLI::App& command, std::function<void(std::uint64_t)> take, const std::string& meaning);
void add_rig(CLI::App& command, RigOptions& rig);
/// Where the rig stands.
CLI::Option& add_environment(CLI::App& command, std::string& environment);
void add_plan(CLI::App& command, RecordOptions& record);
/// Frames and speeds of a plan's legs. `quota`: the default of --valid-per-leg, in words.
void add_legs(CLI::App& command, RecordOptions& record, const std::string& quota);
/// --seconds: the length of a recording without a servo.
void add_seconds(CLI::App& command, RecordOptions& record);
/// --output: the folder; `meaning`: what it is to the command.
void add_folder(CLI::App& command, std::filesystem::path& folder, const std::string& meaning);

}  // namespace thermorig::app
