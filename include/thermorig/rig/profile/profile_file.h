// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "thermorig/core/profile.h"
#include "thermorig/io/files/part_file.h"

namespace thermorig::rig {

/// A rig profile from TOML text. Keys that are left out keep their defaults. Throws Error(bad_usage) that
/// names file, line and what is allowed for unknown keys, wrong types and values out of range.
/// `file_name` is used in messages only.
RigProfile parse_profile(const std::string& text, const std::string& file_name);

/// The same from a file. Throws Error(bad_usage) if it cannot be read.
RigProfile read_profile(const std::filesystem::path& path);

/// TOML text with a comment for each key; parse_profile() gives the same profile back.
std::string profile_text(const RigProfile& profile);

/// A profile that is read, changed and written again, or written for the first time: nobody else changes it
/// from here on.
class ProfileFile {
 public:
  /// Makes its folder if it is not there. Throws Error(storage) where none could be written, and
  /// Error(no_permission) where another program is about to.
  explicit ProfileFile(const std::filesystem::path& path);

  /// profile_text(). Once.
  void write(const RigProfile& profile);

 private:
  files::PartFile part_;
};

/// Throws as read_profile() if there is a file at `path` that is no profile, and as ProfileFile: to be asked
/// before an hour is spent on what is to be written.
void require_profile_storage(const std::filesystem::path& path);

/// Writes it whatever was there.
void write_profile(const std::filesystem::path& path, const RigProfile& profile);

}  // namespace thermorig::rig
