// SPDX-License-Identifier: MIT
#include "folder_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "sha256.h"
#include "thermorig/core/error.h"

namespace thermorig::publication {

namespace {

namespace fs = std::filesystem;
using files::Descriptor;

constexpr const char* is_link = "is a link: put the file itself there";
constexpr const char* is_no_file = "is no file";

[[noreturn]] void refuse_folder(const fs::path& folder, const std::string& why) {
  throw Error(ExitCode::storage, "the folder cannot be searched: " + why, folder.string(),
              "change its permissions");
}

/// Why this entry, which is called `*.h5` or is a link to a folder, is no session.
std::string problem_of(const fs::directory_entry& entry) {
  std::error_code hidden;
  if (entry.is_symlink(hidden)) return is_link;
  return entry.is_regular_file(hidden) ? "" : is_no_file;
}

bool concerns_sessions(const fs::directory_entry& entry) {
  std::error_code dangling;
  return entry.path().extension() == ".h5" || (entry.is_symlink(dangling) && entry.is_directory(dangling));
}

Descriptor open_folder(const fs::path& folder) {
  Descriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!opened) refuse_folder(folder, std::strerror(errno));
  return opened;
}

}  // namespace

std::vector<FolderPath> sessions_in(const fs::path& folder) {
  std::error_code hidden;  // what is not a folder, whatever it is
  if (!fs::is_directory(folder, hidden))
    throw Error(ExitCode::bad_usage, "is no folder", folder.string(), "name the folder of the data set");
  std::vector<FolderPath> found;
  std::error_code failure;
  for (fs::recursive_directory_iterator entry(folder, failure), end; !failure && entry != end;
       entry.increment(failure))
    if (concerns_sessions(*entry))
      found.push_back({entry->path().lexically_relative(folder).generic_string(), problem_of(*entry)});
  if (failure) refuse_folder(folder, failure.message());
  std::sort(found.begin(), found.end(),
            [](const FolderPath& one, const FolderPath& other) { return one.path < other.path; });
  return found;
}

FolderFile::FolderFile(const fs::path& folder, const std::string& path) : path_(folder / path) {
  file_ = open_folder(folder);
  const fs::path within(path);
  for (auto part = within.begin(); part != within.end() && problem_.empty(); ++part)
    step_into(*part, std::next(part) == within.end());
  if (bytes_ > session::StoredFile::bytes_max) problem_ = "is larger than any session: 4 GiB";
}

void FolderFile::step_into(const fs::path& name, bool is_last) {
  struct stat info {};
  // Looked at before it is opened: opening a pipe waits, and opening a port moves its lines.
  if (::fstatat(file_.get(), name.c_str(), &info, AT_SYMLINK_NOFOLLOW) != 0) {
    is_missing_ = errno == ENOENT || errno == ENOTDIR;
    problem_ = is_missing_ ? "is missing" : std::string("cannot be read: ") + std::strerror(errno);
  } else if (S_ISLNK(info.st_mode)) {
    problem_ = is_link;
  } else if (is_last ? !S_ISREG(info.st_mode) : !S_ISDIR(info.st_mode)) {
    problem_ = is_no_file;
  }
  if (!problem_.empty()) return;
  const int kind = is_last ? O_NONBLOCK | O_NOCTTY : O_DIRECTORY;
  Descriptor next(::openat(file_.get(), name.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC | kind));
  if (!next && (errno == EACCES || errno == EPERM))
    throw Error(ExitCode::no_permission, std::string("cannot be read: ") + std::strerror(errno),
                path_.string(), "see who may read it: ls -l " + path_.string());
  if (!next || ::fstat(next.get(), &info) != 0 || (is_last && !S_ISREG(info.st_mode)))
    problem_ = "became another file meanwhile";
  bytes_ = is_last ? static_cast<std::uint64_t>(info.st_size) : 0;
  file_ = std::move(next);
}

void FolderFile::read(std::uint64_t offset, std::span<std::byte> out) const {
  while (!out.empty()) {
    const ssize_t count = ::pread(file_.get(), out.data(), out.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0)
      throw Error(ExitCode::storage,
                  std::string("cannot be read: ") +
                      (count == 0 ? "it became shorter meanwhile" : std::strerror(errno)),
                  path_.string(), "check the disk (dmesg), and leave the data set alone meanwhile");
    offset += static_cast<std::uint64_t>(count);
    out = out.subspan(static_cast<std::size_t>(count));
  }
}

std::string FolderFile::sha256() const {
  Sha256 sum;
  std::vector<std::byte> part(std::min<std::uint64_t>(bytes_, 1U << 20U));
  for (std::uint64_t offset = 0; offset < bytes_; offset += part.size()) {
    part.resize(std::min<std::uint64_t>(part.size(), bytes_ - offset));
    read(offset, part);
    sum.add(part);
  }
  return sum.hexadecimal();
}

}  // namespace thermorig::publication
