// SPDX-License-Identifier: MIT
#include "journal_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "thermorig/core/error.h"

namespace thermorig::journal {

namespace {

using Part = std::span<const std::byte>;

constexpr double bytes_per_megabyte = 1e6;

std::string advice_for(int error_number) {
  switch (error_number) {
    case ENOSPC:
    case EDQUOT:
      return "free some space, or record to another disk with --output";
    case EACCES:
    case EPERM:
    case EROFS:
      return "choose a folder that you may write to with --output";
    case EEXIST:
      return "choose another name: a journal is never overwritten";
    case ENOENT:
    case ENOTDIR:
      return "create the folder first, or choose another with --output";
    default:
      return "check the disk (dmesg), or record to another one with --output";
  }
}

/// `parts` without their first `count` bytes.
void drop_front(std::span<Part> parts, std::size_t count) {
  for (Part& part : parts) {
    const std::size_t dropped = std::min(count, part.size());
    part = part.subspan(dropped);
    count -= dropped;
  }
}

}  // namespace

JournalFile::JournalFile(std::filesystem::path path, std::uint64_t reserve_bytes, files::Disk& disk)
    : disk_(disk), path_(std::move(path)) {
  const auto created = disk_.create(path_, 0600);
  if (!created.good()) refuse("cannot create the journal", created.error_number);
  file_ = created.value;
  try {
    reserve_or_refuse(reserve_bytes);
  } catch (const Error&) {
    abandon();
    throw;
  }
}

JournalFile::~JournalFile() {
  if (file_ != files::OpenFile::none) disk_.close(file_);
}

std::uint64_t JournalFile::free_bytes() const {
  const auto free = disk_.free_bytes(path_);
  return free.good() ? free.value : UINT64_MAX;  // unknown: let the writes tell
}

void JournalFile::reserve_or_refuse(std::uint64_t bytes) {
  const std::uint64_t available = free_bytes();
  if (bytes <= available && reserve(bytes)) return;
  const std::uint64_t missing = bytes - std::min(bytes, available);
  throw Error(
      ExitCode::storage,
      fmt::format("not enough space for the recording: {:.1f} MB needed, {:.1f} MB free, {:.1f} MB missing",
                  static_cast<double>(bytes) / bytes_per_megabyte,
                  static_cast<double>(available) / bytes_per_megabyte,
                  static_cast<double>(missing) / bytes_per_megabyte),
      path_.string(), advice_for(ENOSPC));
}

bool JournalFile::reserve(std::uint64_t bytes) {
  if (bytes <= reserved_) return true;
  // The file stays as long as what was appended, so that a killed recorder leaves no tail of zeros.
  const int error_number = disk_.reserve(file_, bytes);
  if (error_number == ENOSPC || error_number == EDQUOT || error_number == EFBIG) return false;
  const bool is_possible = error_number != EOPNOTSUPP && error_number != ENOSYS;
  if (error_number != 0 && is_possible) refuse("cannot reserve space", error_number);
  can_reserve_ = is_possible;
  reserved_ = bytes;
  return true;
}

void JournalFile::require_sound() const {
  if (failed_) refuse(failure_.action, failure_.error_number);  // what happened first is what has to be known
  if (file_ == files::OpenFile::none) refuse("the journal is closed", EBADF);
}

void JournalFile::append(std::span<const std::span<const std::byte>> parts) {
  require_sound();
  std::array<Part, 3> left{};
  if (parts.size() > left.size()) std::abort();
  std::copy(parts.begin(), parts.end(), left.begin());
  std::size_t missing = 0;
  for (const Part part : parts) missing += part.size();
  const std::size_t total = missing;
  while (missing > 0) {  // once; a disk that took a part of it says at the next call why
    const auto written = disk_.append(file_, std::span(left).first(parts.size()));
    if (!written.good() || written.value == 0)
      fail("cannot write", written.good() ? ENOSPC : written.error_number);
    drop_front(left, written.value);
    missing -= written.value;
  }
  size_ += total;
}

void JournalFile::note_failure(const char* action, int error_number) {
  const std::lock_guard lock(failure_turn_);
  if (failed_) return;
  failure_ = {action, error_number};
  failed_ = true;
}

void JournalFile::fail(const char* action, int error_number) {
  note_failure(action, error_number);
  // A half-written record is cut off. Where that fails as well, its checksum tells.
  disk_.truncate(file_, size_);
  refuse(action, error_number);
}

void JournalFile::sync() {
  require_sound();
  const int error_number = disk_.sync(file_);
  if (error_number == 0) return;
  note_failure("cannot sync", error_number);  // what could not be written is dropped, and that said only once
  refuse("cannot sync", error_number);
}

void JournalFile::sync_folder() {
  const int error_number = disk_.sync_folder(files::folder_of(path_));
  if (error_number != 0) refuse("cannot sync the folder", error_number);
}

void JournalFile::close() {
  require_sound();
  const int truncated = disk_.truncate(file_, size_);
  if (truncated != 0) refuse("cannot close", truncated);
  sync();
  const int closed = disk_.close(std::exchange(file_, files::OpenFile::none));
  if (closed != 0) refuse("cannot close", closed);
}

void JournalFile::abandon() {
  disk_.close(std::exchange(file_, files::OpenFile::none));
  disk_.remove(path_);
}

void JournalFile::refuse(const char* action, int error_number) const {
  throw Error(ExitCode::storage, fmt::format("{}: {}", action, std::strerror(error_number)), path_.string(),
              advice_for(error_number));
}

}  // namespace thermorig::journal
