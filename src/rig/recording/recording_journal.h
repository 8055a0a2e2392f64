// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "thermorig/core/raw_recording.h"
#include "thermorig/rig/recording/recording.h"
#include "thermorig/rig/recording/session_file.h"

namespace thermorig::rig {

/// Where all of a recording is written, before anything else sees it: the journal on the disk, its lock and
/// its syncs. Of a recording that keeps nothing whatever it is given is dropped.
class RecordingJournal {
 public:
  /// Chooses the number, which it puts into the header, and creates the journal, unless `options.keep` is
  /// false. Throws Error: bad_usage, storage.
  RecordingJournal(const RecordingOptions& options, RecordingHeader& header);
  ~RecordingJournal();
  RecordingJournal(const RecordingJournal&) = delete;
  RecordingJournal& operator=(const RecordingJournal&) = delete;

  void received(Device from, std::span<const std::uint8_t> bytes, HostTime arrived);
  void sent(Device to, std::span<const std::uint8_t> bytes, HostTime time);
  void event(const RecordingEvent& event);
  void leg(const LegRecord& leg);
  void estimate(const EstimateRow& row);

  /// Every 10 ms or so. Throws what a sync threw; gives what is to be said of the disk, its space and its
  /// speed.
  std::vector<RecordingEvent> check(HostTime now);

  /// End record, sync. It stays locked until this object goes: nobody but the caller makes a session of it.
  void close(HostTime end);
  /// Removes the closed journal and the folders that were made for it.
  void discard();

  std::uint64_t bytes() const;                       // written
  const SessionFile& file() const { return file_; }  // without names: nothing is kept

 private:
  struct Kept;

  SessionFile file_;
  std::unique_ptr<Kept> kept_;  // null: nothing is kept
};

}  // namespace thermorig::rig
