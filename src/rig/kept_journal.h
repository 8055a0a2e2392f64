// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "thermorig/core/device.h"
#include "thermorig/core/live_estimate.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/rig/recording.h"
#include "thermorig/rig/session_file.h"

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

  void received(Device from, std::span<const std::uint8_t> bytes, HostTime arrived);
  void sent(std::span<const std::uint8_t> bytes, HostTime time);
  void event(const RecordingEvent& event);
  void leg(const LegRecord& leg);
  void estimate(const LiveEstimate& row);

  void check();  // throws what a sync threw
  void close(HostTime end);

  std::uint64_t bytes() const;  // written
  const SessionFile& file() const { return file_; }

 private:
  struct Kept;
  SessionFile file_;
  std::unique_ptr<Kept> kept_;  // none: nothing is kept
};

}  // namespace thermorig::rig
