// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "thermorig/core/chunk.h"
#include "thermorig/core/device.h"
#include "thermorig/core/estimate_row.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/time.h"

namespace thermorig {

/// Everything about a recording that is known before its first byte.
struct RecordingHeader {
  std::string uuid;         // version 4
  std::string environment;  // [a-z0-9-]{1,32}
  int acquisition = 0;      // number within the environment, from 1
  std::string title;
  std::string licence;  // of the data, as its owner states it; empty: not stated
  std::string operator_name, place,
      note;                             // who recorded it, where it stood, what is to be known; may be empty
  std::string start_time_utc;           // ISO 8601 with microseconds and Z, taken at `time_reference`
  HostTime time_reference{};            // host clock value that stands for second 0 of the session
  std::int64_t realtime_offset_ns = 0;  // CLOCK_REALTIME - CLOCK_MONOTONIC at the start
  bool simulated = false;
  std::optional<std::uint64_t> simulation_seed;
  std::string simulation;  // how: "virtual time, firmware's host build", "ports, AVR image", ...
  RigProfile profile;
  std::string plan_name;
  std::string plan_toml;  // the sweep plan as text
  int frames_per_leg = 0;
  std::string creator;  // "thermorig 0.1.0"
  std::string creator_git;
  std::string host_name;
  std::string kernel;
  std::string firmware;                     // what the servo answered to hello, empty if unknown
  std::string shaft_sensor;                 // what measured the shaft, "AS5600"; empty: nothing did
  LiveModel live_model;                     // without a name: no network ran
  std::vector<EstimatorColumn> estimators;  // of a live run, at most most_estimators; else empty
};

enum class EventKind : std::uint8_t {
  info = 0,
  warning = 1,
  device_lost = 2,
  device_back = 3,
  leg_start = 4,  // text: leg, plan step, commanded speed
  leg_end = 5,
  leg_repeated = 6,
  servo_fault = 7,
  stopped = 8,   // by Ctrl-C or a signal
  finished = 9,  // the plan is complete
  mark = 10,     // by the operator: text of the note
  missing = 11,  // a device is not there; the recording goes on with what is left
  gate = 12,     // the network's gate has collapsed
};
inline constexpr EventKind last_event_kind = EventKind::gate;

/// Names in the order of the numbers, as in the file's `flag_meanings` and in messages.
inline constexpr std::array<std::string_view, 13> event_kind_names{
    "info",        "warning", "device_lost", "device_back", "leg_start", "leg_end", "leg_repeated",
    "servo_fault", "stopped", "finished",    "mark",        "missing",   "gate"};
static_assert(event_kind_names.size() == static_cast<std::size_t>(last_event_kind) + 1);

/// Something that happened during a recording, besides bytes.
struct RecordingEvent {
  HostTime time{};
  EventKind kind = EventKind::info;
  std::optional<Device> source;  // none: the host
  std::string message;
};

/// One leg as it was driven: constant commanded speed (back and forth where travel demands it).
struct LegRecord {
  std::uint16_t leg = 0;  // number that the servo's telemetry carries, from 1
  int step = 0;           // index into the plan's legs, from 0; a repeated leg has the same step
  double rate_dps = 0.0;  // commanded, signed
  HostTime begin{};       // the command was acknowledged
  HostTime end{};         // the last frame of the leg arrived
  int frames = 0;
  bool complete = false;  // false: cut short, and repeated or given up
};

/// Bytes of one direction of one port, in chunks: the truth from which everything else is made.
struct RawStream {
  std::vector<std::uint8_t> bytes;
  std::vector<std::uint64_t> chunk_end;  // offset one past each chunk's last byte
  std::vector<std::int64_t> time_ns;     // host clock: when read() returned, or before write() was called

  void append(std::span<const std::uint8_t> chunk, HostTime time);
  std::size_t chunk_count() const { return chunk_end.size(); }
  std::span<const std::uint8_t> chunk(std::size_t index) const;
  HostTime time(std::size_t index) const { return host_time_ns(time_ns[index]); }
};

/// A whole recording before any interpretation: what a journal holds and what a session keeps in `/raw`.
struct RawRecording {
  RecordingHeader header;
  PerDevice<RawStream> received;
  PerDevice<RawStream> sent;  // by the host, to each device
  std::vector<RecordingEvent> events;
  std::vector<LegRecord> legs;
  std::vector<EstimateRow> estimates;  // what a live run showed, frame indices ascending; else empty
  bool complete = false;               // closed by the recorder, not cut short
  HostTime end_time{};                 // of the last record
};

}  // namespace thermorig
