// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "thermorig/core/raw_recording.h"
#include "thermorig/io/files/disk.h"
#include "thermorig/storage/journal/journal.h"

namespace thermorig::rig {

/// Throws Error(storage) with what is missing unless `needed` bytes are free on the disk that `path` will lie
/// on: those of a recording and of the session that is made of it.
void require_space(files::Disk& disk, const std::filesystem::path& path, std::uint64_t needed);

/// A sync that ended later than was promised.
struct LateSync {
  HostDuration waited{};  // the oldest byte that it was for, until its end
  HostDuration lasted{};  // the sync itself
};

/// Watches space and speed of the disk under a journal: lets its reserve grow before it ends, and says once
/// what ought to be known.
class DiskWatch {
 public:
  /// `sync_period`: 0: it is synced at its end alone.
  DiskWatch(journal::JournalWriter& journal, HostDuration sync_period);

  HostDuration sync_period() const { return sync_period_; }

  /// The first look says when the journal is synced. `late`: bytes had to wait for their sync for longer than
  /// was promised: that is said where the sync itself took longer than the period, and from twice the period
  /// on. Looks at the disk once a second.
  std::vector<RecordingEvent> look(HostTime now, const std::optional<LateSync>& late);

 private:
  void look_at_reserve(HostTime now, std::vector<RecordingEvent>& said);
  void look_at_space(HostTime now, std::vector<RecordingEvent>& said);

  journal::JournalWriter& journal_;
  HostDuration sync_period_;
  std::uint64_t step_;  // of the reserve, bytes
  std::optional<HostTime> next_look_;
  HostTime next_late_{};  // that may be told of
  bool reserve_told_ = false;
  bool space_told_ = false;
};

}  // namespace thermorig::rig
