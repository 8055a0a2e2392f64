// SPDX-License-Identifier: MIT
#include "recording_journal.h"

#include <cstring>
#include <optional>
#include <string>

#include "disk_watch.h"
#include "journal_sync.h"
#include "thermorig/core/error.h"
#include "thermorig/io/files/holder.h"
#include "thermorig/rig/sweep/plan.h"
#include "thermorig/storage/journal/journal.h"

namespace thermorig::rig {

struct RecordingJournal::Kept {
  Kept(const SessionFile& file, const RecordingHeader& header, const RecordingOptions& options,
       files::Disk& its_disk)
      : disk(its_disk),
        writer(file.journal, header, expected_journal_bytes(options.plan, options.profile), disk),
        lock(file.journal, files::FileLock::Wait::yes, disk),
        watch(writer, options.sync_period) {
    if (options.sync_period == HostDuration::zero()) return;
    if (options.virtual_time)
      next_virtual_sync = header.time_reference + pause_before_sync(options.sync_period, {});
    else
      sync.emplace(writer, options.sync_period);
  }

  files::Disk& disk;
  journal::JournalWriter writer;
  files::FileLock lock;  // `recover` sees that this one is being written
  DiskWatch watch;
  std::optional<JournalSync> sync;
  // In virtual time all that happens has to happen again in the same order: it is synced in line.
  std::optional<HostTime> next_virtual_sync;
};

RecordingJournal::RecordingJournal(const RecordingOptions& options, RecordingHeader& header) {
  if (!options.keep) return;
  files::Disk& disk = options.disk != nullptr ? *options.disk : files::real_disk();
  // Held until the journal has its own lock: `recover` waits for it, lest it take a new journal for an old
  // one.
  const FolderLock folder(options.output, options.environment, disk);
  file_ = folder.next(compact_utc(header.start_time_utc));
  header.acquisition = file_.acquisition;
  require_space(disk, file_.journal, expected_recording_bytes(options.plan, options.profile));
  kept_ = std::make_unique<Kept>(file_, header, options, disk);
}

RecordingJournal::~RecordingJournal() = default;

void RecordingJournal::received(Device from, std::span<const std::uint8_t> bytes, HostTime arrived) {
  if (kept_) kept_->writer.received(from, bytes, arrived);
}

void RecordingJournal::sent(Device to, std::span<const std::uint8_t> bytes, HostTime time) {
  if (kept_) kept_->writer.sent(to, bytes, time);
}

void RecordingJournal::event(const RecordingEvent& event) {
  if (kept_) kept_->writer.event(event);
}

void RecordingJournal::leg(const LegRecord& leg) {
  if (kept_) kept_->writer.leg(leg);
}

void RecordingJournal::estimate(const EstimateRow& row) {
  if (kept_) kept_->writer.estimate(row);
}

std::vector<RecordingEvent> RecordingJournal::check(HostTime now) {
  if (!kept_) return {};
  if (kept_->next_virtual_sync && now >= *kept_->next_virtual_sync) {
    kept_->next_virtual_sync = now + pause_before_sync(kept_->watch.sync_period(), {});
    kept_->writer.sync();
  }
  return kept_->watch.look(now, kept_->sync ? kept_->sync->check() : std::nullopt);
}

void RecordingJournal::close(HostTime end) {
  if (!kept_) return;
  kept_->sync.reset();
  kept_->writer.close(end);
}

void RecordingJournal::discard() {
  if (!kept_) return;
  const int removed = kept_->disk.remove(file_.journal);
  if (removed != 0)
    throw Error(ExitCode::storage, std::string("cannot remove the journal: ") + std::strerror(removed),
                file_.journal.string(), "remove it: nothing is in it");
  for (const auto& folder : file_.made_folders)
    if (kept_->disk.remove_folder(folder) != 0) break;  // another recording is in it
}

std::uint64_t RecordingJournal::bytes() const {
  return kept_ ? kept_->writer.bytes_written() : 0;
}

}  // namespace thermorig::rig
