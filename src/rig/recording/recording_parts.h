// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "device_presence.h"
#include "device_watch.h"
#include "recording_journal.h"
#include "recording_start.h"
#include "stream_requests.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/rig/recording/recording.h"
#include "thermorig/rig/sweep/sweep_walker.h"
#include "witness_watch.h"

namespace thermorig::rig {

/// How a recording ends.
struct RecordingEnd {
  std::optional<Error> failure;
  std::optional<std::string> stopped_by;  // on request; empty: of a signal
  bool servo_is_gone = false;             // it cannot be stopped from here
  bool is_coming() const { return failure || stopped_by; }
};

/// What a recording consists of. Bytes, time and ends: recording.cpp; devices that go, and come back:
/// recording_devices.cpp.
struct Recording::Parts {
  Parts(const RecordingOptions& given, HostTime now, Send send_to)
      : options(given),
        begin(now),
        send(std::move(send_to)),
        wall_offset_ns(rig::wall_offset_ns(options)),
        header(make_header(options, now)),
        journal(options, header),
        pipeline(options.profile),
        servo_driver(make_servo_driver(options.profile.servo)),
        commander(*servo_driver),
        sweep(options.plan, options.profile.servo, options.profile.camera.output_rate_hz, commander),
        requests(options.profile),
        devices(options.profile, options.start_patience_s, now),
        presence{{presence_of(Device::camera), presence_of(Device::gyro), presence_of(Device::servo)}},
        start(options),
        witnesses(options.profile) {
    if (!has_servo()) presence[Device::servo].never_was_there();
  }

  bool has_servo() const { return options.profile.servo.is_there(); }

  DevicePresence presence_of(Device device) const {
    return {device, options.profile, options.replug_patience_s};
  }
  void take(const pipeline::Streams& streams, const std::vector<Measurement>& measurements, HostTime arrived);
  void observe(const std::vector<Measurement>& measurements, HostTime arrived);
  void take_streams(const pipeline::Streams& streams, HostTime arrived);
  void begin_when_ready(HostTime now);
  void check_devices(HostTime now);
  PerDevice<bool> done_without() const;
  PreflightCounts counts() const;
  void refuse(const PreflightReport& report, HostTime now);
  void drive(HostTime now);
  void drain_sweep(HostTime now);
  void note_return(Device device, HostTime now);
  bool awaits_any() const;
  bool waits() const;
  void await(Device device, const Error& error, HostTime now);
  void lose_port_again(Device device, const Error& error, HostTime now);
  void interrupt(Device device, HostTime now);
  void look_for_returns(HostTime now);
  void note_back(Device device, HostTime now);
  void greet_again(HostTime now);
  void ask_for_streams(HostTime now);
  void write_to(Device device, const std::vector<std::uint8_t>& bytes, HostTime now);
  void note_epoch(const ClockEpoch& epoch, HostTime now);
  void note_layout(HostTime now);
  void event(const RecordingEvent& event);
  void close(HostTime now);
  void fail(const Error& error, HostTime now);
  void lose(Device device, const Error& error, HostTime now, bool has_port = true);

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
  std::int64_t wall_offset_ns;  // at the begin
  RecordingHeader header;
  RecordingJournal journal;
  pipeline::Pipeline pipeline;
  std::unique_ptr<ServoDriver> servo_driver;
  ServoDriver& commander;  // the same
  SweepWalker sweep;
  StreamRequests requests;
  DeviceWatch devices;
  PerDevice<DevicePresence> presence;
  RecordingStart start;
  WitnessWatch witnesses;
  RecordingEnd end;
  std::vector<DeviceAbsence> absences;
  std::string gone_advice;  // of the first that it went on without
  std::vector<RecordingEvent> new_events;
  std::optional<LabelledSample> last_sample;
  std::uint64_t layout_changes_to_say = 1;
};

}  // namespace thermorig::rig
