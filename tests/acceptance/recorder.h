// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "app/program.h"
#include "read_ledger.h"
#include "served_rig.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::tests {

/// The built program, which records from a rig that this process serves. The two have three ports in common
/// and nothing else.
class RecorderOnPorts : public ProgramTest {
 protected:
  RecorderOnPorts();
  ~RecorderOnPorts() override;

  /// Starts `thermorig record`: +90 and -90 deg/s for so many frames, with short rests.
  pid_t start_recording(int frames_per_leg);

  /// Waits until the journal says that the first leg has begun.
  void wait_for_first_leg() const;
  /// Waits for something that must happen; gives up when the recording has ended, or after a long time.
  void wait_until(const std::function<bool()>& happened) const;

  std::filesystem::path only_journal() const;
  session::Session only_session() const;

  /// What read() gave the program; none if it was built with sanitizers, which do not suffer a preload.
  std::optional<read_ledger_port> read_from(Device device) const;

  /// Every byte of `device` in the session lies in one piece in what was delivered to the program. Where that
  /// piece begins and how much was delivered behind it.
  struct Extent {
    std::size_t head = 0, size = 0, tail = 0;
  };
  Extent extent_of(Device device, const session::Session& session) const;

  /// From 300 ms after the last byte that the servo received, in its own time, the shaft turns by less than
  /// 1 deg/s.
  void expect_rest_after_last_byte() const;

  ServedRig rig_{3, "garden"};

 private:
  void open_ledger();
  bool has_ended() const;

  read_ledger* ledger_ = nullptr;
  pid_t process_ = 0;
};

/// Events of one kind, their messages.
std::vector<std::string> messages_of(const RawRecording& raw, EventKind kind);

}  // namespace thermorig::tests
