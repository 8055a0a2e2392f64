// SPDX-License-Identifier: MIT
#include <sys/stat.h>

#include <algorithm>

#include "attributes.h"
#include "counters_list.h"
#include "group_reader.h"
#include "recording_columns.h"
#include "sample_columns.h"
#include "scalars.h"
#include "thermorig/core/error.h"
#include "thermorig/recording_header/header_json.h"
#include "thermorig/session/session.h"

namespace thermorig::session {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& path, const std::string& what) {
  throw Error(ExitCode::not_a_session, what, path.string(),
              "name a session that thermorig wrote; if this is one, it is damaged: take a copy of it from "
              "elsewhere, or its journal with thermorig recover");
}

/// A session file that has shown its format; gives access to its groups.
class SessionFile {
 public:
  explicit SessionFile(const fs::path& path) : path_(path) {
    struct stat info {};
    if (::stat(path.c_str(), &info) != 0 || !S_ISREG(info.st_mode)) refuse(path, "is not a regular file");
    file_bytes_ = static_cast<std::uint64_t>(info.st_size);
    file_ = Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open it as HDF5");
    if (!has_attribute(id(), "format") || get_text_attribute(id(), "format") != format_name)
      refuse(path, "is HDF5, but not a thermorig session");
    const std::string version = get_text_attribute(id(), "format_version");
    if (!version.starts_with(format_major))
      refuse(path,
             "is a session of format version " + version + ", and this program reads " + format_version);
  }

  hid_t id() const { return file_.get(); }

  GroupReader group(const std::string& path) const {
    return GroupReader(id(), path, reference_, file_bytes_);
  }

  RecordingHeader read_header() {
    const auto text = get_text_attribute(group("/rig").id(), "header_json");
    auto header = recording_header::header_from_json_text(text, path_.string());
    reference_ = header.time_reference;
    return header;
  }

 private:
  fs::path path_;
  std::uint64_t file_bytes_ = 0;
  Handle file_;
  HostTime reference_{};
};

void check_stream(const RawStream& stream, const std::string& name) {
  const std::uint64_t end = stream.chunk_end.empty() ? 0 : stream.chunk_end.back();
  if (end != stream.bytes.size() || !std::is_sorted(stream.chunk_end.begin(), stream.chunk_end.end()))
    throw Hdf5Failure("believe the chunks of /raw/" + name);
}

RawStream read_stream(const SessionFile& file, const std::string& name, const char* time_name) {
  RawStream stream;
  auto group = file.group("/raw/" + name);
  raw_columns(group, stream, time_name, "");
  check_stream(stream, name);
  return stream;
}

RawRecording read_recording(SessionFile& file) {
  RawRecording raw;
  raw.header = file.read_header();
  for (const Device device : all_devices)
    raw.received[device] = read_stream(file, std::string(name_of(device)), "arrival_ns");
  raw.sent = read_stream(file, "sent", "sent_ns");
  auto events = file.group("/events");
  event_columns(events, raw.events);
  auto servo = file.group("/servo");
  step_columns(servo, raw.legs);
  raw.complete = get_attribute<std::uint8_t>(file.id(), "closed_by_recorder") != 0;
  raw.end_time = host_time_ns(get_attribute<std::int64_t>(file.id(), "end_time_ns"));
  return raw;
}

State state_of(const std::string& name) {
  for (const State state : {State::complete, State::recovered, State::partial})
    if (name_of(state) == name) return state;
  throw Hdf5Failure("believe the state " + name);
}

void read_scalars(const SessionFile& file, Session& session) {
  session.state = state_of(get_text_attribute(file.id(), "state"));
  session.settle_s = get_attribute<double>(file.group("/samples").id(), "settle_s");
  const auto camera = file.group("/camera");
  session.camera_mode = get_text_attribute(camera.id(), "mode");
  session.frame_period_s = get_attribute<double>(camera.id(), "frame_period_s");
  for (const Device device : all_devices) {
    const auto raw = file.group("/raw/" + std::string(name_of(device)));
    for (const auto& counter : counter_names)
      session.counters[device].*counter.member = get_attribute<std::uint64_t>(raw.id(), counter.name);
  }
}

std::vector<TimedPong> read_pongs(const SessionFile& file) {
  std::vector<PingExchange> exchanges;
  auto group = file.group("/sync/servo");
  ping_columns(group, exchanges);
  std::vector<TimedPong> pongs;
  for (const auto& exchange : exchanges) pongs.push_back(exchange.pong);
  return pongs;
}

void check_samples(const Session& session) {
  for (const auto& sample : session.samples)
    if (sample.frame_index >= session.frames.size()) throw Hdf5Failure("believe /samples/frame");
}

/// The session without what was decoded.
Session read_foundation(SessionFile& file) {
  Session session;
  session.raw = read_recording(file);
  read_scalars(file, session);
  if (get_attribute<std::uint32_t>(file.id(), "scalars_crc32") != scalars_crc32(session))
    throw Hdf5Failure("believe the attributes: they differ from their checksum");
  return session;
}

Session read_all(SessionFile& file) {
  Session session = read_foundation(file);
  auto camera = file.group("/camera");
  camera_columns(camera, session.frames);
  auto gyro = file.group("/gyro");
  gyro_columns(gyro, session.gyro);
  auto servo = file.group("/servo");
  servo_columns(servo, session.servo);
  session.pongs = read_pongs(file);
  auto samples = file.group("/samples");
  sample_columns(samples, session.samples);
  check_samples(session);
  return session;
}

template <typename Read>
auto read_or_explain(const fs::path& path, Read read) {
  try {
    prepare_hdf5();
    SessionFile file(path);
    return read(file);
  } catch (const Hdf5Failure& failure) {
    refuse(path, failure.what());
  } catch (const std::bad_alloc&) {
    refuse(path, "claims to be larger than the memory of this computer");
  }
}

}  // namespace

Session read_session(const fs::path& path) {
  return read_or_explain(path, read_all);
}

RawRecording read_raw(const fs::path& path) {
  return read_or_explain(path, read_foundation).raw;
}

}  // namespace thermorig::session
