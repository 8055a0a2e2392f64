// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "device_watch.h"
#include "gate_watch.h"
#include "kept_journal.h"
#include "recording_start.h"
#include "servo_link.h"
#include "sweep_walker.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/rig/recording.h"
#include "thermorig/rig/replug.h"
#include "thermorig/rig/stream_requests.h"

namespace thermorig::rig {

/// What a recording consists of. Bytes, time and ends: recording.cpp; devices that go, and come back:
/// recording_devices.cpp.
struct Recording::Parts {
  Parts(const RecordingOptions& given, HostTime now, Send send_to)
      : options(given),
        begin(now),
        send(std::move(send_to)),
        header(make_header(options, now)),
        journal(options, header),
        pipeline(options.profile),
        commander(options.profile.servo),
        sweep(options.plan, options.profile.servo, options.profile.camera.output_rate_hz, commander),
        requests(options.profile),
        replug(options.profile, options.replug_patience_s),
        devices(options.profile, options.start_patience_s, now) {}

  void take(const pipeline::Streams& streams, const std::vector<Measurement>& measurements, HostTime arrived);
  void observe(const std::vector<Measurement>& measurements, HostTime arrived);
  void take_streams(const pipeline::Streams& streams, HostTime arrived);
  void begin_when_ready(HostTime now);
  void check_devices(HostTime now);
  GateCounts counts() const;
  GateReport judged(HostTime now) const;
  void listen_anew(HostTime now);
  bool passes_gate(HostTime now);
  void refuse(const GateReport& report, HostTime now);
  void drive(HostTime now);
  void drain_sweep(HostTime now);
  void note_return(Device device, HostTime now);
  bool waits() const;
  bool is_halting() const;
  void miss_at_the_end(Device device, const Error& error, HostTime now);
  void await(Device device, const Error& error, bool has_port, HostTime now);
  void lose_port_again(Device device, const Error& error, HostTime now);
  void interrupt(Device device, HostTime now);
  void look_for_returns(HostTime now);
  void note_back(Device device, HostTime now);
  void greet_again(HostTime now);
  void ask_for_streams(HostTime now);
  void write_to(Device device, const std::vector<std::uint8_t>& bytes, HostTime now);
  void note_epoch(const ClockEpoch& epoch, HostTime now);
  void event(const RecordingEvent& event);
  void fail(const Error& error, HostTime now);
  void lose(Device device, const Error& error, HostTime now, bool has_port = true);
  bool is_needed(Device device) const { return device == Device::servo || options.needed[device]; }

  /// Runs `step`; what the rig's devices refuse ends the recording, a disk that refuses is thrown on.
  template <typename Step>
  void guarded(HostTime now, Step step) {
    try {
      step();
    } catch (const Error& error) {
      if (error.code() == ExitCode::storage) throw;
      fail(error, now);
    }
  }

  RecordingOptions options;
  HostTime begin;
  Send send;
  RecordingHeader header;
  KeptJournal journal;
  pipeline::Pipeline pipeline;
  ServoCommander commander;
  SweepWalker sweep;
  StreamRequests requests;
  Replug replug;
  DeviceWatch devices;
  PerDevice<bool> port_lost{};
  std::vector<DeviceAbsence> absences;
  GateWatch gate_watch;
  std::optional<GateReport> gate;  // of the time before the start
  std::vector<RecordingEvent> new_events;
  std::optional<LabelledSample> last_sample;
  std::optional<Error> failure;
  PerDevice<bool> gone{};                      // not there, not needed
  PerDevice<bool> was_gone{};                  // for a while at least
  PerDevice<std::uint64_t> good_while_gone{};  // messages
  std::string gone_advice;                     // of the first
  bool was_ready = false;                      // every device was there, and the servo was greeted
  bool began = false;
  bool may_start = false;
  bool greeting_noted = false;
  bool stopped = false;
  std::string stopped_by;
  bool finish_noted = false;
  bool servo_gone = false;
};

}  // namespace thermorig::rig
