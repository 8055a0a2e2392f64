// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "thermorig/core/raw_recording.h"
#include "thermorig/io/files/disk.h"

namespace thermorig::journal {

/// Append-only raw recording: the truth of a session while it is being recorded. Format:
/// docs/journal_format.md. Every record carries a magic, the journal's id, a sequence number, its length and
/// a CRC-32; each append is one write. kill -9 loses nothing that an append returned from. A failed write or
/// sync throws Error(storage), and so does everything after it: what was appended before stays readable.
class JournalWriter {
 public:
  /// Creates the file (never overwrites, follows no link; mode 0600), reserves `reserve_bytes` on the disk
  /// and makes the header durable. Throws Error(storage) if the file exists, the folder is not writable or
  /// the space is not there (with how much is missing); Error(bad_usage) if the header could not be read
  /// back.
  JournalWriter(const std::filesystem::path& path, const RecordingHeader& header, std::uint64_t reserve_bytes,
                files::Disk& disk = files::real_disk());
  ~JournalWriter();
  JournalWriter(JournalWriter&&) noexcept;
  JournalWriter& operator=(JournalWriter&&) noexcept;

  void received(Device from, std::span<const std::uint8_t> bytes, HostTime arrived);
  void sent(Device to, std::span<const std::uint8_t> bytes, HostTime time);
  void event(const RecordingEvent& event);
  void leg(const LegRecord& leg);
  void estimate(const EstimateRow& row);  // of the header's estimators; frame indices ascend

  /// fdatasync: what has been appended survives a loss of power. May be called from another thread, but not
  /// while or after close() runs.
  void sync();

  /// Space for the whole file of so many bytes, ahead of what is written. False if the disk has no room.
  bool reserve(std::uint64_t bytes);
  std::uint64_t reserved() const;
  /// False where the file system cannot reserve: reserved() then is only what is expected.
  bool can_reserve() const;
  std::uint64_t free_bytes() const;  // of the disk beside that; UINT64_MAX: unknown

  /// Writes the end record, truncates the reserve, syncs and closes. `end` is the host time of the end.
  void close(HostTime end);

  std::uint64_t bytes_written() const;

 private:
  struct File;
  std::size_t estimators_;  // of the recording
  std::unique_ptr<File> file_;
};

/// What a journal held and what could not be read.
struct JournalContents {
  RawRecording recording;
  std::uint64_t records = 0;
  std::uint64_t bytes_read = 0;
  std::uint64_t bytes_ignored = 0;  // after the last good record: a torn tail; 0 in a closed journal
};

/// Reads every good record, up to the first that is not. Throws Error(not_a_session) if the file cannot be
/// read, or does not start with a good header; Error(storage) if the disk fails. Takes at most about as much
/// memory as the file is long.
JournalContents read_journal(const std::filesystem::path& path, files::Disk& disk = files::real_disk());

/// Does it start like one? Throws Error(not_a_session) if it cannot be read.
bool is_journal(const std::filesystem::path& path, files::Disk& disk = files::real_disk());

/// Is it empty, zero or the begin of a journal, with no good record in it, wherever? So it is if the program
/// or the power ended before the header was on the disk: until then nothing is recorded. Throws
/// Error(not_a_session) if it cannot be read.
bool holds_nothing(const std::filesystem::path& path, files::Disk& disk = files::real_disk());

}  // namespace thermorig::journal
