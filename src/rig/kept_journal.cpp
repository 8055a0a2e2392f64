// SPDX-License-Identifier: MIT
#include "kept_journal.h"

#include <optional>

#include "file_lock.h"
#include "journal_sync.h"
#include "recording_start.h"
#include "thermorig/journal/journal.h"

namespace thermorig::rig {

struct KeptJournal::Kept {
  Kept(const SessionFile& file, const RecordingHeader& header, std::uint64_t reserve_bytes)
      : journal(file.journal, header, reserve_bytes) {}

  journal::JournalWriter journal;
  std::optional<FileLock> lock;  // tells `recover` that this one is being written
  std::optional<JournalSync> sync;
};

KeptJournal::KeptJournal(const RecordingOptions& options, RecordingHeader& header) {
  if (!options.keep) return;
  const FolderLock folder(options.output, options.environment);
  file_ = folder.next(compact_utc(header.start_time_utc));
  header.acquisition = file_.acquisition;
  kept_ = std::make_unique<Kept>(file_, header, expected_journal_bytes(options));
  kept_->lock.emplace(file_.journal, FileLock::Wait::yes);
  if (options.sync_while_recording) kept_->sync.emplace(kept_->journal);
}

KeptJournal::~KeptJournal() = default;

void KeptJournal::received(Device from, std::span<const std::uint8_t> bytes, HostTime arrived) {
  if (kept_) kept_->journal.received(from, bytes, arrived);
}

void KeptJournal::sent(std::span<const std::uint8_t> bytes, HostTime time) {
  if (kept_) kept_->journal.sent(bytes, time);
}

void KeptJournal::event(const RecordingEvent& event) {
  if (kept_) kept_->journal.event(event);
}

void KeptJournal::leg(const LegRecord& leg) {
  if (kept_) kept_->journal.leg(leg);
}

void KeptJournal::estimate(const LiveEstimate& row) {
  if (kept_) kept_->journal.estimate(row);
}

void KeptJournal::check() {
  if (kept_ && kept_->sync) kept_->sync->check();
}

void KeptJournal::close(HostTime end) {
  if (!kept_) return;
  kept_->sync.reset();
  kept_->journal.close(end);
  kept_->lock.reset();
}

std::uint64_t KeptJournal::bytes() const {
  return kept_ ? kept_->journal.bytes_written() : 0;
}

}  // namespace thermorig::rig
