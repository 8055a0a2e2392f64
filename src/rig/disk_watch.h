// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "thermorig/core/raw_recording.h"
#include "thermorig/files/disk.h"
#include "thermorig/journal/journal.h"
#include "thermorig/rig/sync_policy.h"

namespace thermorig::rig {

/// What a session needs beside the journal that it is made of, bytes.
std::uint64_t session_bytes_beside(std::uint64_t journal_bytes);

/// Throws Error(storage) with what is missing unless `journal_bytes` and the session that is made of them fit
/// on the disk that `path` will lie on.
void require_space(files::Disk& disk, const std::filesystem::path& path, std::uint64_t journal_bytes);

/// Watches space and speed of the disk under a journal: lets its reserve grow before it ends, and says once
/// what ought to be known.
class DiskWatch {
 public:
  DiskWatch(journal::JournalWriter& journal, const SyncPolicy& policy);

  /// The first look says when the journal is synced. `delay`: longer than was promised, that bytes had to
  /// wait for their sync. Looks at the disk once a second.
  std::vector<RecordingEvent> look(HostTime now, std::optional<HostDuration> delay);

 private:
  void look_at_reserve(HostTime now, std::vector<RecordingEvent>& said);
  void look_at_space(HostTime now, std::vector<RecordingEvent>& said);

  journal::JournalWriter& journal_;
  SyncPolicy policy_;
  std::uint64_t step_;  // of the reserve, bytes
  std::optional<HostTime> next_look_;
  HostTime next_delay_{};  // that may be told of
  bool reserve_told_ = false;
  bool space_told_ = false;
};

}  // namespace thermorig::rig
