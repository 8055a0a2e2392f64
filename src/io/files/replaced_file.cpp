// SPDX-License-Identifier: MIT
#include "thermorig/io/files/replaced_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <system_error>
#include <thread>
#include <utility>

#include "thermorig/core/error.h"
#include "thermorig/io/files/holder.h"

namespace thermorig::files {

namespace {

namespace fs = std::filesystem;

constexpr int links_max = 40;  // as many as the system follows

/// Where a symbolic link leads, also if nothing is there yet; any other path as it is.
fs::path behind_links(fs::path path) {
  std::error_code hidden;
  for (int links = 0; links < links_max && fs::is_symlink(path, hidden); ++links)
    path = path.parent_path() / fs::read_symlink(path, hidden);
  return path;
}

/// One who stays: of two that wanted the lock at the same time, one still has the file open when it goes.
std::optional<std::string> lasting_writer_of(const fs::path& path) {
  constexpr int looks = 50;
  std::optional<std::string> writer = other_holder_of(path, Use::writing);
  for (int look = 1; writer && look < looks; ++look) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    writer = other_holder_of(path, Use::writing);
  }
  return writer;
}

}  // namespace

ReplacedFile::ReplacedFile(const fs::path& path, std::string noun, Advice advice, Disk& disk)
    : path_(behind_links(path)), noun_(std::move(noun)), advice_(advice), disk_(&disk) {
  const auto kind = disk_->look(path_);
  if (!kind.good()) refuse(std::strerror(kind.error_number), advice_(kind.error_number));
  if (kind.value == FileKind::missing) return;
  if (kind.value != FileKind::file)
    refuse("the name is taken by a folder, a pipe or a device", "choose another name");
  note();
  if (const std::string protection = disk_->protection(path_); !protection.empty())
    refuse(protection, advice_(EACCES));
}

void ReplacedFile::note() {
  const auto opened = disk_->open_to_lock(path_);
  if (opened.error_number == EACCES)
    throw Error(ExitCode::no_permission, fmt::format("cannot read {}: {}", noun_, std::strerror(EACCES)),
                path_.string(), "see who may read it: ls -l " + path_.string());
  if (!opened.good()) refuse(std::strerror(opened.error_number), advice_(opened.error_number));
  file_ = std::make_unique<ClosedOnExit>(*disk_, opened.value);
  const auto identity = disk_->identity(file_->get());
  if (!identity.good()) refuse(std::strerror(identity.error_number), advice_(identity.error_number));
  before_ = identity.value;
}

void ReplacedFile::refuse(const std::string& why, const std::string& advice) const {
  throw Error(ExitCode::storage, fmt::format("cannot write {}: {}", noun_, why), path_.string(), advice);
}

void ReplacedFile::refuse_as_used(const std::string& holder) const {
  throw Error(ExitCode::no_permission, fmt::format("{} is open to be written in {}", noun_, holder),
              path_.string(), "close it there, then try again");
}

bool ReplacedFile::try_lock() {
  return !file_ || disk_->lock_to_replace(file_->get()) != EWOULDBLOCK;
}

void ReplacedFile::lock() {
  if (!try_lock()) refuse_as_used(other_holder_of(path_, Use::writing).value_or(holder_of(path_)));
  // Locks can be turned off (HDF5_USE_FILE_LOCKING), and not every file system has them.
  if (const auto writer = lasting_writer_of(path_)) refuse_as_used(*writer);
  if (!is_unchanged())
    throw Error(ExitCode::no_permission, fmt::format("another program has just replaced {}", noun_),
                path_.string(), "try again");
}

bool ReplacedFile::is_unchanged() const {
  const auto opened = disk_->open(path_);
  const ClosedOnExit file(*disk_, opened.value);
  if (!opened.good()) return !before_ && opened.error_number == ENOENT;
  const auto identity = disk_->identity(opened.value);
  return identity.good() && identity.value == before_;
}

}  // namespace thermorig::files
