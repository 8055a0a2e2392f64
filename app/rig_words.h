// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "options.h"

namespace CLI {
class App;
class Validator;
}  // namespace CLI

namespace thermorig::app {

// Words that several commands share.
void add_json(CLI::App& command, bool& json);

/// --sync: when what is recorded has to be on the disk.
void add_sync(CLI::App& command, std::string& sync);
/// --replug-patience: how long a device is waited for that goes.
void add_replug(CLI::App& command, double& patience_s);
/// A word that must be one of `names`; for any other the nearest is named.
CLI::Validator one_of(std::vector<std::string> names);
void add_simulated_parts(CLI::App& command, SimulatedParts& parts);
void add_rig(CLI::App& command, RigOptions& rig, std::string& seed);

/// Throws Error(bad_usage) unless it is a whole number from 0 to 2^64 - 1.
std::uint64_t seed_of(const std::string& text);

}  // namespace thermorig::app
