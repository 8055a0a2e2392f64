// SPDX-License-Identifier: MIT
#include "thermorig/storage/session/salvage.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "device_columns.h"
#include "open_session.h"
#include "recording_columns.h"
#include "sent_bytes.h"
#include "thermorig/core/count_text.h"
#include "thermorig/core/error.h"

namespace thermorig::session {

namespace {

template <typename Read>
bool is_left(Read read) {
  try {
    read();
    return true;
  } catch (const Hdf5Failure&) {
    return false;
  }
}

/// The chunks of which all bytes are there.
void drop_torn_chunk(RawStream& stream) {
  while (!stream.chunk_end.empty() && stream.chunk_end.back() > stream.bytes.size())
    stream.chunk_end.pop_back();
  stream.time_ns.resize(stream.chunk_end.size());
  stream.bytes.resize(stream.chunk_end.empty() ? 0 : stream.chunk_end.back());
}

void read_what_is_left(const SessionFile& file, const std::string& name, const char* time_name,
                       HostTime reference, RawStream& stream) {
  if (!is_left([&] { read_stream(file, name, time_name, reference, stream); })) stream = {};
  drop_torn_chunk(stream);
}

Salvaged read_salvaged(SessionFile& file) {
  Salvaged left;
  RawRecording& raw = left.raw;
  raw.header = file.read_header();
  raw.end_time = raw.header.time_reference;
  for (const Device device : all_devices) {
    RawStream& received = raw.received[device];
    read_what_is_left(file, std::string(name_of(device)), "arrival_ns", raw.header.time_reference, received);
    read_what_is_left(file, sent_group(device), "sent_ns", raw.header.time_reference, raw.sent[device]);
    if (received.chunk_count() > 0)
      raw.end_time = std::max(raw.end_time, received.time(received.chunk_count() - 1));
  }
  const auto keep = [](auto& rows, auto read) {
    if (!is_left(read)) rows.clear();
  };
  keep(raw.events, [&] {
    auto events = file.group("/events");
    event_columns(events, raw.events);
  });
  keep(raw.legs, [&] {
    auto servo = file.group("/servo");
    step_columns(servo, raw.legs);
  });
  keep(raw.estimates, [&] { raw.estimates = read_estimates(file, raw.header); });
  keep(left.annotations, [&] { left.annotations = read_annotations(file); });
  return left;
}

}  // namespace

bool is_cut_short(const StoredFile& file) {
  return file.stated_end() > file.size();
}

void require_whole(const StoredFile& file) {
  if (!is_cut_short(file)) return;
  throw Error(ExitCode::not_a_session,
              fmt::format("was cut short: {} of {} bytes are there", count_text(file.size()),
                          count_text(file.stated_end())),
              file.path().string(),
              "copy it again; if this is all there is: thermorig recover " + file.path().string());
}

Salvaged salvage(const StoredFile& file) {
  // Of a file that says that it ought to have a thousand times as many bytes nothing can be left.
  constexpr std::uint64_t largest_share = 1000;
  const std::uint64_t whole = std::max(file.stated_end(), file.size());
  if (whole / largest_share > file.size())
    refuse(file.path(), "was cut short, and too little is left to make anything of it");
  try_first(file, whole, read_salvaged);
  Salvaged left = read_in_turn(file, whole, read_salvaged);
  left.bytes_missing = whole - file.size();
  const bool has_frames = left.raw.received[Device::camera].chunk_count() > 0;
  if (!has_frames)
    refuse(file.path(), fmt::format("was cut short before the raw data of its camera: {} of {} bytes "
                                    "are there",
                                    count_text(file.size()), count_text(whole)));
  return left;
}

}  // namespace thermorig::session
