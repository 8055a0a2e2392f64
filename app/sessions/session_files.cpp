// SPDX-License-Identifier: MIT
#include "session_files.h"

#include "existing_file.h"
#include "thermorig/learning/dataset/dataset.h"

namespace thermorig::app {

namespace fs = std::filesystem;

std::vector<fs::path> session_files_at(const fs::path& path) {
  require_existing(path);
  std::error_code hidden;  // opening it says why
  if (!fs::is_directory(path, hidden)) return {path};
  return dataset::find_sessions({path});
}

std::vector<fs::path> session_files_at(const std::vector<fs::path>& paths) {
  std::vector<fs::path> files;
  for (const fs::path& path : paths) {
    const std::vector<fs::path> there = session_files_at(path);
    files.insert(files.end(), there.begin(), there.end());
  }
  return files;
}

}  // namespace thermorig::app
