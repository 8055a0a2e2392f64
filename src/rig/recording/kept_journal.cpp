// SPDX-License-Identifier: MIT
#include "kept_journal.h"

#include <cstring>
#include <optional>
#include <string>

#include "disk_watch.h"
#include "file_lock.h"
#include "journal_sync.h"
#include "thermorig/core/error.h"
#include "thermorig/rig/sweep/expected_size.h"
#include "thermorig/storage/journal/journal.h"

namespace thermorig::rig {

struct KeptJournal::Kept {
  Kept(const SessionFile& file, const RecordingHeader& header, const RecordingOptions& options,
       files::Disk& disk)
      : journal(file.journal, header, expected_journal_bytes(options.plan, options.profile), disk),
        lock(file.journal, FileLock::Wait::yes, disk),
        watch(journal, options.sync) {
    if (options.sync.when == SyncWhen::end) return;
    if (options.virtual_time)
      virtual_sync.emplace(journal, options.sync, header.time_reference);
    else
      sync.emplace(journal, options.sync);
  }

  journal::JournalWriter journal;
  FileLock lock;  // tells `recover` that this one is being written
  DiskWatch watch;
  std::optional<JournalSync> sync;
  std::optional<VirtualSync> virtual_sync;
};

KeptJournal::KeptJournal(const RecordingOptions& options, RecordingHeader& header)
    : disk_(options.disk != nullptr ? options.disk : &files::real_disk()) {
  if (!options.keep) return;
  // Held until the journal has its own lock: `recover` waits for it, lest it take a new journal for an old
  // one.
  const FolderLock folder(options.output, options.environment, *disk_);
  file_ = folder.next(compact_utc(header.start_time_utc));
  header.acquisition = file_.acquisition;
  require_space(*disk_, file_.journal, expected_recording_bytes(options.plan, options.profile));
  kept_ = std::make_unique<Kept>(file_, header, options, *disk_);
}

KeptJournal::~KeptJournal() = default;

journal::JournalWriter* KeptJournal::writer() {
  return kept_ ? &kept_->journal : nullptr;
}

void KeptJournal::frame() {
  if (kept_ && kept_->sync) kept_->sync->frame();
  if (kept_ && kept_->virtual_sync) kept_->virtual_sync->frame();
}

std::vector<RecordingEvent> KeptJournal::check(HostTime now) {
  if (!kept_) return {};
  std::optional<LateSync> late;
  if (kept_->sync) {
    kept_->sync->check();
    late = kept_->sync->take_late();
  }
  if (kept_->virtual_sync) kept_->virtual_sync->tick(now);
  return kept_->watch.look(now, late);
}

void KeptJournal::close(HostTime end) {
  if (!kept_) return;
  kept_->sync.reset();
  kept_->virtual_sync.reset();
  kept_->journal.close(end);
}

void KeptJournal::discard() {
  if (!kept_) return;
  const int removed = disk_->remove(file_.journal);
  if (removed != 0)
    throw Error(ExitCode::storage, std::string("cannot remove the journal: ") + std::strerror(removed),
                file_.journal.string(), "remove it: nothing is in it");
  for (const auto& folder : file_.made_folders)
    if (disk_->remove_folder(folder) != 0) break;  // another recording is in it
}

std::uint64_t KeptJournal::bytes() const {
  return kept_ ? kept_->journal.bytes_written() : 0;
}

}  // namespace thermorig::rig
