// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "fault_disk.h"
#include "thermorig/core/chunk.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/rig/recording/recording.h"

namespace thermorig::storage_test {

/// What was really received or sent, chunk by chunk, and how many calls had been made to the disk when the
/// recorder had taken it.
struct TrueStream {
  RawStream chunks;
  std::vector<std::size_t> calls;
};

/// One recording in virtual time on a disk in memory, with all calls to it, from the first folder to the
/// session.
struct RecordedSession {
  struct Step {
    HostTime now{};
    std::vector<Chunk> chunks;
  };
  rig::RecordingOptions options;
  std::vector<Step> steps;  // what came from the rig: enough to record it again
  std::vector<Call> calls;
  PerDevice<TrueStream> received;
  PerDevice<TrueStream> sent;  // to it
  RawRecording raw;            // before it was closed
  std::size_t frames = 0;
  std::size_t concluded = 0;  // calls when the session was announced

  /// Chunks that have been taken when so many calls had been made.
  std::size_t taken(Device device, std::size_t calls) const;
  /// Chunks that had arrived by then.
  std::size_t arrived(Device device, HostTime by) const;
};

/// Where it lies on the disk.
inline constexpr const char* output_folder = "/rec";

/// A disk with nothing but the root folder.
MemoryDisk new_disk(std::uint64_t capacity = std::uint64_t{1} << 40U);

/// About so many frames of the default rig: four legs between two rests.
RecordedSession record_session(int frames);

/// Records the same once more, on another disk.
struct RecordedAgain {
  bool announced = false;  // a session, that is: no error
  std::string error;       // what was said
  ExitCode code = ExitCode::ok;
  PerDevice<std::size_t> taken{};  // chunks that received() returned from
  HostTime end{};                  // when it failed, or was announced
  std::size_t steps = 0;
};
RecordedAgain record_again(const RecordedSession& session, files::Disk& disk, HostTime* clock);

}  // namespace thermorig::storage_test
