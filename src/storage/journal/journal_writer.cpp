// SPDX-License-Identifier: MIT
#include <sys/random.h>

#include <array>
#include <atomic>
#include <cstdlib>

#include "journal_file.h"
#include "payload.h"
#include "record.h"
#include "thermorig/core/error.h"
#include "thermorig/storage/journal/journal.h"
#include "thermorig/storage/recording_header/header_json.h"

namespace thermorig::journal {

namespace {

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
