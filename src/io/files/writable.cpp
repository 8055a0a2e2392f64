// SPDX-License-Identifier: MIT
#include "thermorig/io/files/writable.h"

#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace thermorig::files {

namespace fs = std::filesystem;

namespace {

constexpr fs::perms writable = fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write;

/// A rename asks the folder alone, and root may do all: who took a file's write permission away wants it
/// kept.
bool is_protected(const fs::path& file) {
  std::error_code hidden;
  const fs::file_status status = fs::status(file, hidden);
  if (!fs::is_regular_file(status)) return false;  // what else it may be is refused when it is written
  return (status.permissions() & writable) == fs::perms::none || ::access(file.c_str(), W_OK) != 0;
}

}  // namespace

fs::path existing_part(fs::path folder) {
  std::error_code ignored;
  folder = fs::absolute(folder, ignored);
  while (!fs::exists(folder, ignored) && folder.has_relative_path()) folder = folder.parent_path();
  return folder;
}

std::string hindrance_of_writing(const fs::path& path) {
  if (is_protected(path)) return "it is write-protected";
  std::error_code hidden;
  const fs::path folder = existing_part(fs::absolute(path, hidden).parent_path());
  if (!fs::is_directory(folder, hidden)) return folder.string() + " is not a folder";
  if (::access(folder.c_str(), W_OK | X_OK) == 0) return "";
  return folder.string() + ": " + std::generic_category().message(errno);
}

}  // namespace thermorig::files
