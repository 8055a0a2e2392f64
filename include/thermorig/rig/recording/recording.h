// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thermorig/core/error.h"
#include "thermorig/core/estimate_row.h"
#include "thermorig/core/measurement.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/io/files/disk.h"
#include "thermorig/rig/recording/health.h"
#include "thermorig/rig/recording/order.h"
#include "thermorig/rig/recording/preflight.h"
#include "thermorig/rig/recording/session_file.h"
#include "thermorig/rig/sweep/plan.h"
#include "thermorig/rig/sweep/quota.h"
#include "thermorig/rig/sweep/sweep.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::rig {

/// Told of each measurement, in order; `arrived`: of the chunk that completed it. What it returns is kept
/// with the recording.
using Observer = std::function<std::optional<EstimateRow>(const Measurement& measurement, HostTime arrived)>;

/// What a recording is made of and where it goes.
struct RecordingOptions {
  std::string environment;
  std::filesystem::path output = "recordings";
  std::string title;
  std::string licence;                     // of the data; empty: not stated
  std::string operator_name, place, note;  // as in the header
  RigProfile profile;
  SweepPlan plan;
  bool simulated = false;
  std::optional<std::uint64_t> simulation_seed;
  std::string simulation;  // "virtual time, firmware's host build", ...
  std::string creator;     // "thermorig 0.1.0"
  std::string creator_git;
  double start_patience_s = 6.0;  // each device must have sent a good message by then
  // The journal is synced so often: a loss of power costs as much. 0: only at its end.
  HostDuration sync_period = std::chrono::milliseconds(125);
  files::Disk* disk = nullptr;     // to keep it on; none: the system's
  double replug_patience_s = 0.0;  // a needed device that goes is waited for so long; 0: the end at once
  std::function<std::int64_t()> realtime_offset_ns;  // io::realtime_offset_ns(), if empty
  bool virtual_time = false;    // times are the simulator's: the start is dated with the wall's clock
  bool keep = true;             // false: no folder, no journal, no session, nothing on the disk
  bool wait_for_start = false;  // nothing moves before allow_start()
  PreflightMode preflight =
      PreflightMode::off;  // else the rig is listened to for 3 s and judged before it is armed
  PerDevice<bool> needed{{true, true, true}};  // without one that is not, it goes on; the servo always is
  std::function<void(const RecordingHeader&)> begun;  // once, before anything else; may be empty
  Observer observe;                                   // may be empty
  LiveModel live_model;                               // of the network that `observe` asks
  std::vector<EstimatorColumn> estimators;            // of the rows that it returns
};

/// A device that went while it is needed: the recording waits for it.
struct AwaitedDevice {
  std::string why;  // "unplugged"
  double waited_s = 0.0;
  double left_s = 0.0;  // until the recording ends without it
};

/// A device was away, and came back.
struct DeviceAbsence {
  Device device = Device::camera;
  HostTime begin{};
  HostTime end{};
};

/// Everything the live display shows.
struct RecordingProgress {
  HostTime time{};
  double elapsed_s = 0.0;
  SweepProgress sweep;
  PerDevice<DeviceHealth> health;
  std::vector<RecordingEvent> events;  // since the last progress
  std::optional<LabelledSample> last_sample;
  PerDevice<bool> gone{};    // not there, and not needed
  PerDevice<bool> absent{};  // and the rig has none
  PerDevice<std::optional<AwaitedDevice>> awaited;
  std::uint64_t kept_bytes = 0;  // of the journal; 0 if nothing is kept
  bool stopping = false;
  double heard_s = 0.0;  // since all devices send and the servo has answered
};

/// What has happened to a recording.
struct RecordingOutcome {
  bool is_kept = true;                    // false: there is no journal
  bool was_ready = false;                 // every device was there, and the preflight check did not refuse it
  std::optional<Error> failure;           // why it ended early, if not on request
  std::optional<std::string> stopped_by;  // who asked for the end; empty: a signal
  std::vector<Device> gone;               // that it went on without, for a while at least
  std::string gone_advice;                // what to try for the first of them
  std::vector<DeviceAbsence> absences;    // that were waited for, and are over
  std::vector<SweepTrouble> troubles;     // of the servo, each kind once
  // What the preflight check said before the start or, as long as it has not begun, would say now. None
  // before all devices have sent for a second, and with PreflightMode::off.
  std::optional<PreflightReport> preflight;
};

/// How a recording ended. `session` is there whenever bytes could be kept.
struct RecordingResult {
  ExitCode exit = ExitCode::ok;  // ok, finished_lossy, device_lost, interrupted
  std::string message;           // what happened if not ok, or if anything was interrupted; ready to print
  std::string advice;            // what to try, may be empty
  int acquisition = 0;
  std::filesystem::path session;  // empty if it was left as a journal (second Ctrl-C)
  std::filesystem::path journal;  // exists only if `session` is empty
  session::State state = session::State::complete;
  session::Quality quality;
  std::vector<SpeedQuota> speeds;            // of the plan, ascending, by the labels in the session
  std::vector<std::string> lacking;          // without a servo: what the turns should have shown, to print
  double duration_s = 0.0;                   // on the recording's clock
  std::optional<PreflightReport> preflight;  // of the rig at rest; none if it was not judged
};

using ProgressHandler = std::function<void(const RecordingProgress&)>;

/// One acquisition from its first byte to the closed journal: chunk -> journal -> pipeline -> commander and
/// sweep. The caller owns the ports and the clock. Errors of the servo or of a device that went away end the
/// recording properly: see outcome().
class Recording {
 public:
  using Send = std::function<void(Device to, std::span<const std::uint8_t>)>;

  /// Chooses the number and creates the journal. `now` becomes second 0. Throws Error: bad_usage, storage.
  Recording(const RecordingOptions& options, HostTime now, Send send);
  ~Recording();
  Recording(const Recording&) = delete;
  Recording& operator=(const Recording&) = delete;

  /// One chunk from a device. Journal first, then everything else.
  void received(Device from, std::span<const std::uint8_t> bytes, HostTime arrived);

  /// A port failed or was unplugged. A device that is needed is waited for, see RecordingOptions.
  void lost(Device device, const std::string& why, HostTime now);

  /// The port of a device that was lost is open again. Whether the device is back, what it sends will show.
  void returned(Device device, HostTime now);

  /// Its port is there again, but will not open, and waiting does not help.
  void refused(Device device, const Error& why, HostTime now);

  /// Devices whose ports are gone and would be opened again.
  std::vector<Device> lost_ports() const;

  /// A device was not there to begin with: `why` says so, and what to try.
  void missing(Device device, const Error& why, HostTime now);

  /// Moves everything on; bytes for the devices go out through the callback. Every 10 ms or so.
  void tick(HostTime now);

  /// Ctrl-C: stops the servo, then done(). `who` asked for it, for the log: "the page".
  void request_stop(HostTime now, const std::string& who = {});

  void mark(const std::string& note, HostTime now);
  void allow_start(HostTime now);
  void carry_out(const Order& order, HostTime now);

  /// The servo is at rest, or gone: nothing more will be recorded.
  bool done() const;

  RecordingOutcome outcome(HostTime now) const;

  RecordingProgress progress(HostTime now);

  /// End record, sync, close. Returns where the journal and its session belong.
  SessionFile close(HostTime now);

  /// Closes and removes the journal, and the folders that were made for it: nothing was recorded that is
  /// worth keeping.
  void discard(HostTime now);

  const SessionFile& file() const;
  const SweepPlan& plan() const;
  files::Disk& disk() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// After `recording` is done: closes it, finalises the journal, says how it ended. A recording that failed
/// before every device was there leaves no file: its Error is thrown.
RecordingResult conclude(Recording& recording, HostTime now);

}  // namespace thermorig::rig
