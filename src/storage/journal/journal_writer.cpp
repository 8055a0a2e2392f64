// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <span>
#include <utility>

#include "record.h"
#include "thermorig/core/error.h"
#include "thermorig/io/files/disk.h"
#include "thermorig/storage/journal/journal.h"
#include "thermorig/storage/recording_header/header_json.h"

namespace thermorig::journal {

namespace {

/// The file under a journal: creates, reserves, appends, syncs. Every refusal of the disk is Error(storage).
/// After a write or a sync that failed nothing is written any more: what was not synced before may be lost,
/// even if a later sync succeeds.
class JournalFile {
 public:
  JournalFile(std::filesystem::path path, std::uint64_t reserve_bytes, files::Disk& disk);
  ~JournalFile();
  JournalFile(const JournalFile&) = delete;
  JournalFile& operator=(const JournalFile&) = delete;

  /// All parts, or Error(storage); a record that did not fit is taken back.
  void append(std::span<const std::span<const std::byte>> parts);
  void sync();
  void sync_folder();

  /// Reserves up to `bytes` from the file's front. False if the disk has no room for them.
  bool reserve(std::uint64_t bytes);
  std::uint64_t reserved() const { return reserved_; }
  /// False: the file system cannot, and reserved() is only what is expected.
  bool can_reserve() const { return can_reserve_; }
  std::uint64_t free_bytes() const;  // of the disk, beside the reserve; UINT64_MAX: unknown

  /// Gives the unused reserve back, syncs and closes.
  void close();
  /// Closes and removes it: nothing is in it yet.
  void abandon();

  std::uint64_t size() const { return size_; }

 private:
  void reserve_or_refuse(std::uint64_t bytes);
  void require_sound() const;
  void note_failure(const char* action, int error_number);
  [[noreturn]] void fail(const char* action, int error_number);
  [[noreturn]] void refuse(const char* action, int error_number) const;

  files::Disk& disk_;
  std::filesystem::path path_;
  files::OpenFile file_ = files::OpenFile::none;
  std::uint64_t size_ = 0;
  std::uint64_t reserved_ = 0;
  bool can_reserve_ = true;
  std::mutex failure_turn_;  // syncs come from another thread
  std::atomic<bool> failed_ = false;
  struct Failure {
    const char* action = "";
    int error_number = 0;
  } failure_;  // the first; written before `failed_`
};

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

using Bytes = std::span<const std::uint8_t>;

/// Random, so that the records of an older journal on the same disk blocks are never taken for ours.
std::uint64_t new_journal_id() {
  std::uint64_t id = 0;
  if (::getrandom(&id, sizeof id, 0) != static_cast<ssize_t>(sizeof id))
    throw Error(ExitCode::failed, "the system gives no random numbers", "getrandom", "");
  return id;
}

Bytes bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

}  // namespace

struct JournalWriter::File {
  File(const std::filesystem::path& path, std::uint64_t reserve_bytes, files::Disk& disk)
      : file(path, reserve_bytes, disk), id(new_journal_id()) {}

  void append(RecordType type, std::uint8_t device, Bytes first, Bytes second = {}) {
    const std::size_t length = first.size() + second.size();
    if (length > payload_max_bytes) std::abort();  // a bug: no read() returns so much
    const std::array payload{first, second};
    const auto front =
        encode_front({type, device, id, sequence, static_cast<std::uint32_t>(length)}, payload);
    const std::array<std::span<const std::byte>, 3> parts{std::as_bytes(std::span(front)),
                                                          std::as_bytes(first), std::as_bytes(second)};
    file.append(parts);
    ++sequence;
    bytes_written.store(file.size(), std::memory_order_relaxed);
  }

  JournalFile file;
  std::uint64_t id;
  std::uint64_t sequence = 0;
  std::atomic<std::uint64_t> bytes_written = 0;
};

JournalWriter::JournalWriter(const std::filesystem::path& path, const RecordingHeader& header,
                             std::uint64_t reserve_bytes, files::Disk& disk)
    : estimators_(header.estimators.size()) {
  const std::string text = recording_header::header_to_json_text(header);
  if (text.size() > payload_max_bytes)
    throw Error(ExitCode::bad_usage, "the profile and the plan are too long to be stored", path.string(),
                "shorten them: together they may hold 16 MB");
  file_ = std::make_unique<File>(path, reserve_bytes, disk);
  try {
    file_->append(RecordType::header, 0, bytes_of(text));
    file_->file.sync();
    file_->file.sync_folder();
  } catch (const Error&) {
    file_->file.abandon();  // else recovery would find a journal without a beginning
    throw;
  }
}

JournalWriter::~JournalWriter() = default;
JournalWriter::JournalWriter(JournalWriter&&) noexcept = default;
JournalWriter& JournalWriter::operator=(JournalWriter&&) noexcept = default;

void JournalWriter::received(Device from, std::span<const std::uint8_t> bytes, HostTime arrived) {
  file_->append(RecordType::received, static_cast<std::uint8_t>(from), encode_time(arrived), bytes);
}

void JournalWriter::sent(Device to, std::span<const std::uint8_t> bytes, HostTime time) {
  file_->append(RecordType::sent, static_cast<std::uint8_t>(to), encode_time(time), bytes);
}

void JournalWriter::event(const RecordingEvent& event) {
  file_->append(RecordType::event, 0, encode_event(event));
}

void JournalWriter::leg(const LegRecord& leg) {
  file_->append(RecordType::leg, 0, encode_leg(leg));
}

void JournalWriter::estimate(const EstimateRow& row) {
  file_->append(RecordType::estimates, 0, encode_estimates(row, estimators_));
}

void JournalWriter::sync() {
  file_->file.sync();
}

bool JournalWriter::reserve(std::uint64_t bytes) {
  return file_->file.reserve(bytes);
}

std::uint64_t JournalWriter::reserved() const {
  return file_->file.reserved();
}

bool JournalWriter::can_reserve() const {
  return file_->file.can_reserve();
}

std::uint64_t JournalWriter::free_bytes() const {
  return file_->file.free_bytes();
}

void JournalWriter::close(HostTime end) {
  file_->append(RecordType::end, 0, encode_time(end));
  file_->file.close();
}

std::uint64_t JournalWriter::bytes_written() const {
  return file_->bytes_written.load(std::memory_order_relaxed);
}

}  // namespace thermorig::journal
