// SPDX-License-Identifier: MIT
#include "existing_file.h"

#include "thermorig/core/error.h"
#include "thermorig/core/printable.h"

namespace thermorig::app {

void require_existing(const std::filesystem::path& path) {
  std::error_code hidden;  // a folder that may not be searched: opening says so
  if (std::filesystem::status(path, hidden).type() != std::filesystem::file_type::not_found) return;
  const std::string folder = path.has_parent_path() ? path.parent_path().string() : ".";
  throw Error(ExitCode::bad_usage, "there is no such file", path.string(),
              "check the name: ls " + shell_word(folder));
}

}  // namespace thermorig::app
