// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "column.h"
#include "device_columns.h"
#include "thermorig/core/annotation.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/storage/session/annotations.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::session {

// The tables of what a recording is made from. Archive is GroupWriter or GroupReader.

/// One direction of one port. `time_name`: "arrival_ns" or "sent_ns". `set_end`, `set_time`: how a reader
/// takes an element of the stream's chunk_end and time_ns.
template <typename Archive, typename Stream, typename SetEnd, typename SetTime>
void raw_columns(Archive& archive, Stream& stream, const char* time_name, const char* time_long_name,
                 SetEnd set_end, SetTime set_time) {
  const auto self = [](auto& value) -> auto& {
    return value;
  };
  // Bytes last: of those that are left of a cut file the times are known.
  archive.bare_axis("chunk", "chunk, as one read() or write() moved it", stream.chunk_end, "chunk_end");
  archive.share_axis(stream.time_ns);
  archive.template column<std::uint64_t>({"chunk_end", "1", "offset one past the chunk's last byte"},
                                         stream.chunk_end, self, set_end);
  archive.template column<std::int64_t>({time_name, "ns", time_long_name}, stream.time_ns, self, set_time);
  archive.bare_axis("byte", "byte, from the first ever read or sent", stream.bytes, "bytes", raw_bytes_max);
  archive.template field<std::uint8_t>({"bytes", "1", "bytes"}, stream.bytes, self);
}

inline constexpr std::uint8_t host_source = 255;

template <typename Archive, typename Rows>
void event_columns(Archive& archive, Rows& events) {
  archive.time_axis({"time", "s", "time since time_reference [s]"}, events, &RecordingEvent::time);
  archive.template column<std::uint8_t>(
      {"kind", "1", "kind of the event", "", flag_values(event_kind_names)}, events,
      [](const auto& row) { return row.kind; },
      [](auto& row, std::uint8_t value) { row.kind = checked_enum(value, last_event_kind); });
  archive.template column<std::uint8_t>(
      {"source",
       "1",
       "where it happened",
       "",
       {Flags::Kind::values, {0, 1, 2, host_source}, {"camera", "gyro", "servo", "host"}}},
      events,
      [](const auto& row) { return row.source ? static_cast<std::uint8_t>(*row.source) : host_source; },
      [](auto& row, std::uint8_t value) {
        if (value != host_source) row.source = checked_enum(value, Device::servo);
      });
  archive.texts({"message", "1", "what happened"}, events, &RecordingEvent::message);
}

/// The legs as they were driven: /servo/step_*.
template <typename Archive, typename Rows>
void step_columns(Archive& archive, Rows& legs) {
  archive.template axis<std::uint16_t>(
      {"step_leg", "1", "number of the leg", "what the column leg carries, from 1"}, legs, &LegRecord::leg);
  archive.template field<std::int32_t>(
      {"step_plan", "1", "index into the plan's legs", "from 0; a repeated leg has the same"}, legs,
      &LegRecord::step);
  archive.time_column({"step_start", "s", "the command was acknowledged [s]"}, legs, &LegRecord::begin);
  archive.time_column({"step_end", "s", "the last frame of the leg arrived [s]"}, legs, &LegRecord::end);
  archive.template field<double>({"step_rate", "deg/s", "commanded speed [deg/s]"}, legs,
                                 &LegRecord::rate_dps);
  archive.template field<std::int32_t>({"step_frames", "1", "frames of the leg"}, legs, &LegRecord::frames);
  archive.template column<std::uint8_t>(
      {"step_complete", "1", "was the leg driven to its end?", "", flag_values({"cut_short", "complete"})},
      legs, [](const auto& row) { return row.complete ? 1 : 0; },
      [](auto& row, std::uint8_t value) { row.complete = value != 0; });
}

/// A command to the servo, in words.
struct TimedCommand {
  HostTime time{};
  std::string text;
};

/// /servo/command_*: written for people; /raw/sent holds the bytes.
template <typename Archive, typename Rows>
void command_columns(Archive& archive, Rows& commands) {
  archive.time_axis({"command_time", "s", "time since time_reference before the command was written [s]"},
                    commands, &TimedCommand::time);
  archive.texts({"command_text", "1", "command to the servo"}, commands, &TimedCommand::text);
}

/// /quality/speed*: written for people; everybody can count them in /samples.
template <typename Archive, typename Rows>
void speed_columns(Archive& archive, Rows& speeds) {
  archive.template axis<double>({"speed", "deg/s", "commanded speed [deg/s]"}, speeds,
                                &Quality::Speed::rate_dps);
  archive.template field<std::int32_t>({"speed_frames", "1", "frames at this speed"}, speeds,
                                       &Quality::Speed::frames);
  archive.template field<std::int32_t>({"speed_valid", "1", "valid frames at this speed"}, speeds,
                                       &Quality::Speed::valid);
}

/// The texts of /rig. Before format 2.0 header_json held them too, and they were for people.
inline const Column profile_column{"profile_toml", "1", "profile of the rig, TOML"};
inline const Column plan_column{"plan_toml", "1", "sweep plan, TOML"};

/// A text that holds every other attribute against what was written: see stored_attributes.h.
inline const Column attribute_sums_column{
    "attribute_crc32", "1", "CRC-32 of each attribute that thermorig wrote",
    "a line an attribute: CRC-32 of its type, shape and values, hexadecimal; a blank; object@name"};

/// An answer to a ping, with the time at which the ping was sent.
struct PingExchange {
  TimedPong pong;
  std::int64_t host_send_ns = unknown;
};

template <typename Archive, typename Rows>
void ping_columns(Archive& archive, Rows& exchanges) {
  archive.time_axis(
      {"time", "s", "time since time_reference at which the answer arrived [s]"}, exchanges,
      [](auto& row) -> auto& { return row.pong.arrival; });
  archive.template field<std::uint32_t>(
      {"token", "1", "number that ping and answer share"}, exchanges,
      [](auto& row) -> auto& { return row.pong.token; });
  archive.template field<std::int64_t>({"host_send_ns", "ns", "host clock before the ping was written [ns]",
                                        "-2^63: the ping is not in /raw/sent"},
                                       exchanges, &PingExchange::host_send_ns);
  archive.template column<std::int64_t>(
      {"host_receive_ns", "ns", "host clock when the answer's last byte was read [ns]"}, exchanges,
      [](const auto& row) { return to_ns(row.pong.arrival); },
      [](auto& row, std::int64_t ns) { row.pong.arrival = host_time_ns(ns); });
  archive.template field<std::uint32_t>(
      {"device_receive_ticks", "us", "servo's clock when the ping's last byte came in [us]"}, exchanges,
      [](auto& row) -> auto& { return row.pong.receive_us; });
  archive.template field<std::uint32_t>(
      {"device_send_ticks", "us", "servo's clock when the answer's first byte went out [us]"}, exchanges,
      [](auto& row) -> auto& { return row.pong.send_us; });
  archive.template field<std::uint64_t>(
      {"byte_begin", "1", "offset of the first byte in the raw stream"}, exchanges,
      [](auto& row) -> auto& { return row.pong.span.begin; });
  archive.template column<std::uint32_t>(
      {"byte_count", "1", "length in bytes in the raw stream"}, exchanges,
      [](const auto& row) { return row.pong.span.size(); },
      [](auto& row, std::uint32_t count) { row.pong.span.end = row.pong.span.begin + count; });
}

/// /annotations: what was said of a recording afterwards, in that order. Archive is GroupWriter or
/// GroupReader.
template <typename Archive, typename Rows>
void annotation_columns(Archive& archive, Rows& annotations) {
  archive.bare_axis("annotation", "annotation, in the order in which they were made", annotations, "kind",
                    most_annotations);
  archive.template column<std::uint8_t>(
      {"kind", "1", "what it says", "", flag_values(annotation_kind_names)}, annotations,
      [](const auto& row) { return row.kind; },
      [](auto& row, std::uint8_t value) { row.kind = checked_enum(value, last_annotation_kind); });
  archive.texts({"made_utc", "1", "when it was made, UTC"}, annotations, &Annotation::made_utc);
  archive.texts({"text", "1", "the note, the name of the environment, or why it is excluded"}, annotations,
                &Annotation::text);
  archive.template field<std::int32_t>(
      {"acquisition", "1", "number within the environment", "0: it names no environment"}, annotations,
      &Annotation::acquisition);
  archive.template field<double>(
      {"begin", "s", "begin of what is excluded, since time_reference [s]", "0 where nothing is"},
      annotations, &Annotation::begin_s);
  archive.template field<double>(
      {"end", "s", "end of what is excluded, since time_reference [s]", "0 where nothing is"}, annotations,
      &Annotation::end_s);
}

}  // namespace thermorig::session
