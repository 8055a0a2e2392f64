// SPDX-License-Identifier: MIT
#include "recording_journal.h"

#include <cstring>
#include <optional>
#include <string>
#include <utility>

#include "disk_watch.h"
#include "journal_sync.h"
#include "thermorig/core/error.h"
#include "thermorig/io/files/holder.h"
#include "thermorig/rig/sweep/plan.h"
#include "thermorig/storage/journal/journal.h"

namespace thermorig::rig {

namespace {

/// The journal on the disk, with its lock and its syncs.
class KeptJournal final : public RecordingJournal {
 public:
  KeptJournal(SessionFile file, const RecordingHeader& header, const RecordingOptions& options,
              files::Disk& disk)
      : RecordingJournal(std::move(file)),
        disk_(disk),
        writer_(this->file().journal, header, expected_journal_bytes(options.plan, options.profile), disk),
        lock_(this->file().journal, files::FileLock::Wait::yes, disk),
        watch_(writer_, options.sync) {
    if (options.sync.when == SyncWhen::end) return;
    if (options.virtual_time)
      virtual_sync_.emplace(writer_, options.sync, header.time_reference);
    else
      sync_.emplace(writer_, options.sync);
  }

  void received(Device from, std::span<const std::uint8_t> bytes, HostTime arrived) override {
    writer_.received(from, bytes, arrived);
  }
  void sent(Device to, std::span<const std::uint8_t> bytes, HostTime time) override {
    writer_.sent(to, bytes, time);
  }
  void event(const RecordingEvent& event) override { writer_.event(event); }
  void leg(const LegRecord& leg) override { writer_.leg(leg); }
  void estimate(const EstimateRow& row) override { writer_.estimate(row); }
  void frame() override;
  std::vector<RecordingEvent> check(HostTime now) override;
  void close(HostTime end) override;
  void discard() override;
  std::uint64_t bytes() const override { return writer_.bytes_written(); }

 private:
  files::Disk& disk_;
  journal::JournalWriter writer_;
  files::FileLock lock_;  // tells `recover` that this one is being written
  DiskWatch watch_;
  std::optional<JournalSync> sync_;
  std::optional<VirtualSync> virtual_sync_;
};

void KeptJournal::frame() {
  if (sync_) sync_->frame();
  if (virtual_sync_) virtual_sync_->frame();
}

std::vector<RecordingEvent> KeptJournal::check(HostTime now) {
  std::optional<LateSync> late;
  if (sync_) {
    sync_->check();
    late = sync_->take_late();
  }
  if (virtual_sync_) virtual_sync_->tick(now);
  return watch_.look(now, late);
}

void KeptJournal::close(HostTime end) {
  sync_.reset();
  virtual_sync_.reset();
  writer_.close(end);
}

void KeptJournal::discard() {
  const int removed = disk_.remove(file().journal);
  if (removed != 0)
    throw Error(ExitCode::storage, std::string("cannot remove the journal: ") + std::strerror(removed),
                file().journal.string(), "remove it: nothing is in it");
  for (const auto& folder : file().made_folders)
    if (disk_.remove_folder(folder) != 0) break;  // another recording is in it
}

}  // namespace

std::unique_ptr<RecordingJournal> open_journal(const RecordingOptions& options, RecordingHeader& header) {
  if (!options.keep) return std::make_unique<RecordingJournal>();
  files::Disk& disk = options.disk != nullptr ? *options.disk : files::real_disk();
  // Held until the journal has its own lock: `recover` waits for it, lest it take a new journal for an old
  // one.
  const FolderLock folder(options.output, options.environment, disk);
  SessionFile file = folder.next(compact_utc(header.start_time_utc));
  header.acquisition = file.acquisition;
  require_space(disk, file.journal, expected_recording_bytes(options.plan, options.profile));
  return std::make_unique<KeptJournal>(std::move(file), header, options, disk);
}

}  // namespace thermorig::rig
