// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "thermorig/core/profile.h"

namespace thermorig::rig {

/// A rig profile from TOML text. Keys that are left out keep their defaults. Throws Error(bad_usage) that
/// names file, line and what is allowed for unknown keys, wrong types and values out of range.
/// `file_name` is used in messages only.
RigProfile parse_profile(const std::string& text, const std::string& file_name);

/// The same from a file. Throws Error(bad_usage) if it cannot be read.
RigProfile read_profile(const std::filesystem::path& path);

/// TOML text with a comment for each key; parse_profile() gives the same profile back.
std::string profile_text(const RigProfile& profile);

/// Throws as read_profile() if there is a file at `path` that is no profile, and Error(storage) if none could
/// be written there: to be asked before an hour is spent on what is to be written.
void require_profile_storage(const std::filesystem::path& path);

/// Writes profile_text() to `path`: to a temporary name, then renamed over it. Makes the folder if it is not
/// there. Throws Error(storage).
void write_profile(const std::filesystem::path& path, const RigProfile& profile);

}  // namespace thermorig::rig
