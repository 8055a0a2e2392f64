// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "thermorig/core/raw_recording.h"
#include "thermorig/rig/recording/recording.h"
#include "thermorig/rig/recording/session_file.h"

namespace thermorig::rig {

/// Where all of a recording is written, before anything else sees it. This one is of a recording that keeps
/// nothing: whatever it is given is dropped. open_journal() makes the one of a recording that is kept.
class RecordingJournal {
 public:
  RecordingJournal() = default;
  virtual ~RecordingJournal() = default;
  RecordingJournal(const RecordingJournal&) = delete;
  RecordingJournal& operator=(const RecordingJournal&) = delete;

  virtual void received(Device, std::span<const std::uint8_t>, HostTime /*arrived*/) {}
  virtual void sent(Device, std::span<const std::uint8_t>, HostTime) {}
  virtual void event(const RecordingEvent&) {}
  virtual void leg(const LegRecord&) {}
  virtual void estimate(const EstimateRow&) {}
  virtual void frame() {}  // a whole frame has been received: it may be synced now

  /// Every 10 ms or so. Throws what a sync threw; gives what is to be said of the disk, its space and its
  /// speed.
  virtual std::vector<RecordingEvent> check(HostTime) { return {}; }

  /// End record, sync. It stays locked until this object goes: nobody but the caller makes a session of it.
  virtual void close(HostTime) {}
  /// Removes the closed journal and the folders that were made for it.
  virtual void discard() {}

  virtual std::uint64_t bytes() const { return 0; }  // written
  const SessionFile& file() const { return file_; }

 protected:
  explicit RecordingJournal(SessionFile file) : file_(std::move(file)) {}

 private:
  SessionFile file_;  // without names: nothing is kept
};

/// Chooses the number, which it puts into the header, and creates the journal, unless `options.keep` is
/// false. Throws Error: bad_usage, storage.
std::unique_ptr<RecordingJournal> open_journal(const RecordingOptions& options, RecordingHeader& header);

}  // namespace thermorig::rig
