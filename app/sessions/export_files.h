// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace thermorig::app {

/// A file that is to be written.
struct NewFile {
  std::filesystem::path path;
  std::string bytes;
};

/// Writes all or none, in folders that are made where they are missing. Nothing is overwritten. Throws
/// Error(storage).
void write_new_files(const std::vector<NewFile>& files);

}  // namespace thermorig::app
