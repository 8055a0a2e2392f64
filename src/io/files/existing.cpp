// SPDX-License-Identifier: MIT
#include "thermorig/io/files/existing.h"

#include "thermorig/core/error.h"
#include "thermorig/core/printable.h"

namespace thermorig::files {

namespace fs = std::filesystem;

void require_existing(const fs::path& path) {
  std::error_code failure, hidden;
  const fs::file_status status = fs::status(path, failure);
  const bool is_circle = failure == std::errc::too_many_symbolic_link_levels;
  // A folder that may not be searched: opening says so.
  if (status.type() != fs::file_type::not_found && !is_circle) return;
  if (fs::is_symlink(fs::symlink_status(path, hidden)))
    throw Error(ExitCode::bad_usage, is_circle ? "is a link that leads in a circle" : "is a link to nothing",
                path.string(), "see where it leads: ls -l " + shell_word(path.string()));
  const std::string folder = path.has_parent_path() ? path.parent_path().string() : ".";
  throw Error(ExitCode::bad_usage, "there is no such file or folder", path.string(),
              "check the name: ls " + shell_word(folder));
}

}  // namespace thermorig::files
