// SPDX-License-Identifier: MIT
#include "thermorig/io/files/file_identity.h"

#include <sys/stat.h>

#include <system_error>

namespace thermorig::files {

namespace {

constexpr int links_max = 40;  // as many as the system follows
constexpr std::int64_t ns_per_s = 1'000'000'000;

}  // namespace

std::optional<FileIdentity> identity_of(const std::filesystem::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return std::nullopt;
  return FileIdentity{info.st_dev, info.st_ino, info.st_size,
                      ns_per_s * info.st_mtim.tv_sec + info.st_mtim.tv_nsec};
}

std::filesystem::path behind_links(std::filesystem::path path) {
  std::error_code hidden;
  for (int links = 0; links < links_max && std::filesystem::is_symlink(path, hidden); ++links)
    path = path.parent_path() / std::filesystem::read_symlink(path, hidden);
  return path;
}

}  // namespace thermorig::files
