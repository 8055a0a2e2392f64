// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "thermorig/core/raw_recording.h"
#include "thermorig/rig/recording/recording.h"
#include "thermorig/rig/recording/session_file.h"

namespace thermorig::journal {
class JournalWriter;
}

namespace thermorig::rig {

/// The journal of a recording with its lock and its syncs; or nothing at all, where nothing is kept.
class KeptJournal {
 public:
  /// Chooses the number, which it puts into the header, and creates the journal, unless `options.keep` is
  /// false. Throws Error: bad_usage, storage.
  KeptJournal(const RecordingOptions& options, RecordingHeader& header);
  ~KeptJournal();
  KeptJournal(const KeptJournal&) = delete;
  KeptJournal& operator=(const KeptJournal&) = delete;

  /// What is received, sent and told is written to it before anything else sees it. Null: nothing is kept.
  journal::JournalWriter* writer();
  void frame();  // a whole frame has been received: it may be synced now

  /// Every 10 ms or so. Throws what a sync threw; gives what is to be said of the disk, its space and its
  /// speed.
  std::vector<RecordingEvent> check(HostTime now);

  /// End record, sync. It stays locked until this object goes: nobody but the caller makes a session of it.
  void close(HostTime end);
  /// Removes the closed journal and the folders that were made for it.
  void discard();

  std::uint64_t bytes() const;  // written
  const SessionFile& file() const { return file_; }

 private:
  struct Kept;
  files::Disk* disk_;
  SessionFile file_;
  std::unique_ptr<Kept> kept_;  // none: nothing is kept
};

}  // namespace thermorig::rig
