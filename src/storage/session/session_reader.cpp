// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <mutex>
#include <optional>
#include <set>

#include "attributes.h"
#include "estimate_columns.h"
#include "file_driver.h"
#include "format.h"
#include "group_reader.h"
#include "message_marks.h"
#include "profile_attributes.h"
#include "recording_columns.h"
#include "sample_columns.h"
#include "scalars.h"
#include "sent_bytes.h"
#include "stored_attributes.h"
#include "sync_attributes.h"
#include "sync_columns.h"
#include "thermorig/core/count_text.h"
#include "thermorig/core/error.h"
#include "thermorig/sensors/wire/counter_names.h"
#include "thermorig/storage/recording_header/header_json.h"
#include "thermorig/storage/session/annotations.h"
#include "thermorig/storage/session/rows.h"
#include "thermorig/storage/session/salvage.h"
#include "thermorig/storage/session/session.h"
#include "thermorig/storage/session/trial.h"
#include "trial.h"

namespace thermorig::session {

namespace {

/// Takes rows as a vector does and keeps none of them: whatever a reader checks of a value is checked, and a
/// table of any length takes no memory.
template <typename Row>
class PassedRows {
 public:
  using value_type = Row;

  void resize(std::size_t size) { size_ = size; }
  std::size_t size() const { return size_; }
  Row& operator[](std::size_t /*index*/) { return row_; }

 private:
  std::size_t size_ = 0;
  Row row_{};
};

/// What raw_columns() reads of one direction of one port.
struct PassedStream {
  PassedRows<std::uint8_t> bytes;
  PassedRows<std::uint64_t> chunk_end;
  PassedRows<std::int64_t> time_ns;
};

namespace fs = std::filesystem;

constexpr double longest_delay_s = 10.0;

/// "<major>.<minor>.<patch>", of a major version that this program reads.
std::optional<FormatVersion> version_of(const std::string& text) {
  FormatVersion version;
  unsigned patch = 0;
  char behind = 0;
  const int fields =
      std::sscanf(text.c_str(), "%3u.%3u.%3u%c", &version.major, &version.minor, &patch, &behind);
  if (fields != 3 || version.major < first_format_major || version.major > format_version.major)
    return std::nullopt;
  return version;
}

/// A session file that has shown its format; gives access to its groups.
class SessionFile {
 public:
  /// `source` must outlive this.
  explicit SessionFile(DriverSource& source) : path_(source.file->path()) {
    const fs::path& path = path_;
    facts_.bytes = source.end;
    facts_.bytes_there = source.file->size();
    if (source.end == 0) refuse(path, "is empty");
    if (!is_cut()) require_whole(*source.file);
    file_ = open_to_read(source, "open it as HDF5");
    require_nothing_behind(source.used);
    if (!has_attribute(id(), "format") || get_text_attribute(id(), "format") != format_name)
      refuse(path, "is HDF5, but not a thermorig session");
    const std::string version = get_text_attribute(id(), "format_version");
    const auto known = version_of(version);
    if (!known)
      refuse(path, fmt::format("is a session of format version {}, and this program reads versions {} to {}",
                               version, first_format_major, format_version.major));
    facts_.version = *known;
  }

  hid_t id() const { return file_.get(); }
  const fs::path& path() const { return path_; }

  GroupReader group(const std::string& path) const { return GroupReader(id(), path, facts_); }

  bool has_group(const std::string& path) const {
    return check(H5Lexists(id(), path.c_str(), H5P_DEFAULT), "look for groups") > 0;
  }

  RecordingHeader read_header() {
    using recording_header::ProfileAndPlan;
    const bool is_apart = version() >= with_profile_apart;
    header_text_ = get_text_attribute(group("/rig").id(), "header_json");
    auto header = recording_header::header_from_json_text(
        header_text_, path_.string(), is_apart ? ProfileAndPlan::elsewhere : ProfileAndPlan::in_header);
    if (is_apart) {
      header.profile = profile();
      header.plan_toml = group("/rig").text(plan_column);
    }
    facts_.reference = header.time_reference;
    header.licence = licence();
    return header;
  }

  /// As it stands in the file; of use after read_header().
  const std::string& header_text() const { return header_text_; }

  FormatVersion version() const { return facts_.version; }
  bool is_cut() const { return facts_.is_cut(); }

 private:
  /// HDF5 does not look beyond the end that the file states: what was appended would travel with the session,
  /// unseen.
  void require_nothing_behind(std::uint64_t end) const {
    if (end < facts_.bytes)
      refuse(path_, fmt::format("ends after {} bytes, and {} more stand behind", end, facts_.bytes - end));
  }

  /// Other readers may change what stands in attributes: these must be what was written.
  RigProfile profile() const {
    if (facts_.is_cut()) return read_profile(id(), path_);  // the sums are written last
    const std::string sums = group("/quality").text(attribute_sums_column);
    const std::vector<std::string> altered = altered_attributes(id(), profile_group, sums);
    if (!altered.empty()) throw Hdf5Failure("believe " + altered.front() + ": it differs from its checksum");
    return read_profile(id(), path_);
  }

  /// What the attribute says, not the header: owners of data state the licence of files that they have.
  std::string licence() const {
    if (!has_attribute(id(), "license")) return "";
    std::string licence = get_text_attribute(id(), "license");
    if (licence.empty() || licence == licence_not_stated) return "";
    if (!recording_header::is_line(licence))
      refuse(path_, "has an attribute `license` that is not a line of up to 1000 bytes of UTF-8");
    return licence;
  }

  fs::path path_;
  FileFacts facts_;
  Handle file_;
  std::string header_text_;
};

/// Chunks that follow each other and end with the last byte, at times that a recording can have.
template <typename Stream>
void read_stream(const SessionFile& file, const std::string& name, const char* time_name, HostTime reference,
                 Stream& stream) {
  auto group = file.group("/raw/" + name);
  std::uint64_t end = 0;
  const auto set_end = [&](std::uint64_t& at, std::uint64_t chunk_end) {
    if (chunk_end < end) throw Hdf5Failure("believe the chunks of /raw/" + name);
    at = end = chunk_end;
  };
  const auto set_time = [&](std::int64_t& at, std::int64_t ns) {
    if (!is_of_recording(host_time_ns(ns), reference)) throw Hdf5Failure("believe the times of /raw/" + name);
    at = ns;
  };
  raw_columns(group, stream, time_name, "", set_end, set_time);
  if (end != stream.bytes.size() && !file.is_cut()) throw Hdf5Failure("believe the chunks of /raw/" + name);
}

/// Of a live run; other sessions have none. Before format 2 the header named no estimators.
std::vector<EstimateRow> read_estimates(const SessionFile& file, RecordingHeader& header) {
  std::vector<EstimateRow> rows;
  if (!file.has_group("/estimates")) return rows;
  auto group = file.group("/estimates");
  estimate_row_columns(group, rows);
  if (file.version() < with_named_estimators) {
    estimate_columns_before_format_2(group, rows);
    header.estimators = columns_before_format_2(header.live_model);
  } else {
    estimate_columns_by_name(group, rows, EstimateAxes(header.estimators));
  }
  const auto not_ascending = [](const EstimateRow& a, const EstimateRow& b) {
    return a.frame_index >= b.frame_index;
  };
  if (std::adjacent_find(rows.begin(), rows.end(), not_ascending) != rows.end())
    throw Hdf5Failure("believe /estimates/frame: it does not ascend");
  return rows;
}

/// The bytes of the ports: most of a session, and of no use to who only looks at it.
template <typename Stream>
void read_streams(const SessionFile& file, HostTime reference, PerDevice<Stream>& received,
                  PerDevice<Stream>& sent) {
  for (const Device device : all_devices)
    read_stream(file, std::string(name_of(device)), "arrival_ns", reference, received[device]);
  for (const Device device : all_devices)
    if (device == Device::servo || file.has_group("/raw/" + sent_group(device)))
      read_stream(file, sent_group(device), "sent_ns", reference, sent[device]);
}

RawRecording read_recording(SessionFile& file) {
  RawRecording raw;
  raw.header = file.read_header();
  auto events = file.group("/events");
  event_columns(events, raw.events);
  auto servo = file.group("/servo");
  step_columns(servo, raw.legs);
  raw.estimates = read_estimates(file, raw.header);
  raw.complete = get_attribute<std::uint8_t>(file.id(), "closed_by_recorder") != 0;
  raw.end_time = host_time_ns(get_attribute<std::int64_t>(file.id(), "end_time_ns"));
  if (!is_of_recording(raw.end_time, raw.header.time_reference))
    throw Hdf5Failure("believe the time of its end");
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
    for (const auto& counter : wire::counter_names)
      session.counters[device].*counter.member = get_attribute<std::uint64_t>(raw.id(), counter.name);
  }
}

/// Reads what sync_attributes.h lists.
struct AttributeReader {
  hid_t group;
  void operator()(const char* name, std::string& value) { value = get_text_attribute(group, name); }
  void operator()(const char* name, double& value) { value = get_attribute<double>(group, name); }
  void operator()(const char* name, std::uint32_t& value) {
    value = get_attribute<std::uint32_t>(group, name);
  }
  void operator()(const char* name, bool& value) { value = get_attribute<std::uint8_t>(group, name) != 0; }
  void operator()(const char* name, std::optional<double>& value) {
    const auto stored = get_attribute<double>(group, name);
    value = std::isnan(stored) ? std::nullopt : std::optional(stored);
  }
};

std::string sync_path(Device device) {
  return "/sync/" + std::string(name_of(device));
}

/// The values that stand in attributes.
void read_sync_scalars(const SessionFile& file, SyncReport& sync) {
  for (const Device device : all_devices) {
    const auto group = file.group(sync_path(device));
    AttributeReader reader{group.id()};
    clock_attributes(reader, sync.clock[device], file.version());
  }
  const auto group = file.group("/sync");
  AttributeReader reader{group.id()};
  sync_attributes(reader, sync, file.version());
  // Times are shifted by it: one that is none, or ages, would leave the clock's range.
  if (!(std::abs(sync.servo.delay_s) <= longest_delay_s)) throw Hdf5Failure("believe the servo's delay");
}

void read_sync_tables(const SessionFile& file, SyncReport& sync) {
  for (const Device device : all_devices) {
    auto group = file.group(sync_path(device));
    clock_columns(group, sync.clock[device]);
  }
  auto group = file.group("/sync");
  response_columns(group, sync.servo);
  if (file.version() >= with_checked_constants) bias_columns(group, sync.gyro.bias_course);
}

/// Windows are neighbouring rows, so rows must be the frames one after the other.
template <typename Rows>
void read_samples(const SessionFile& file, std::size_t frames, Rows& samples) {
  auto group = file.group("/samples");
  sample_columns(group, samples);
  std::uint64_t next = 0;
  bool is_in_order = samples.size() == frames;
  group.column<std::uint32_t>({"frame"}, samples, nullptr, [&](auto& /*sample*/, std::uint32_t frame) {
    is_in_order = is_in_order && frame == next++;
  });
  if (!is_in_order) throw Hdf5Failure("believe /samples/frame: the samples are not one a frame, in order");
}

/// Before format 1.1 the label was the commanded speed, and there was no other.
void complete_labels(FormatVersion version, std::vector<LabelledSample>& samples) {
  if (version >= with_sync_report) return;
  constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
  for (LabelledSample& sample : samples) {
    sample.rate_commanded_dps = sample.rate_shaft_dps;
    sample.rate_shaft_half_dps = sample.rate_commanded_half_dps = {unknown, unknown};
    sample.rate_gyro_half_dps = {unknown, unknown};
    sample.gyro_spread_dps = unknown;
  }
}

/// What was said of it afterwards; most sessions have none.
std::vector<Annotation> read_annotations(const SessionFile& file) {
  std::vector<Annotation> annotations;
  if (!file.has_group("/annotations")) return annotations;
  auto group = file.group("/annotations");
  annotation_columns(group, annotations);
  for (const Annotation& annotation : annotations)
    if (const auto problem = problem_of(annotation)) throw Hdf5Failure("believe /annotations: " + *problem);
  return annotations;
}

unsigned label_version_of(FormatVersion version) {
  if (version < with_sync_report) return 1;
  return version < with_corrected_label ? 2 : 3;
}

/// The session without what was decoded.
Session read_foundation(SessionFile& file) {
  Session session;
  session.raw = read_recording(file);
  read_scalars(file, session);
  session.annotations = read_annotations(file);
  session.format_major = file.version().major;
  session.label_version = label_version_of(file.version());
  if (file.version() >= with_sync_report) read_sync_scalars(file, session.sync);
  if (get_attribute<std::uint32_t>(file.id(), "scalars_crc32") !=
      scalars_crc32(session, file.header_text(), file.version()))
    throw Hdf5Failure("believe the attributes: they differ from their checksum");
  return session;
}

/// Tables and texts that only people look at: nothing is made of them, but they shall be what was written.
void check_copies(const SessionFile& file) {
  std::vector<TimedCommand> commands;
  auto servo = file.group("/servo");
  command_columns(servo, commands);
  std::vector<Quality::Speed> speeds;
  auto quality = file.group("/quality");
  speed_columns(quality, speeds);
  if (file.version() >= with_profile_apart) return;
  auto rig = file.group("/rig");
  rig.text(profile_column);
  rig.text(plan_column);
}

/// Reads all attributes, also those that nothing is made of.
std::vector<std::string> read_altered(const SessionFile& file) {
  const std::vector<StoredAttribute> attributes = stored_attributes(file.id());
  if (file.version() < with_attribute_sums) return {};
  return altered_attributes(attributes, file.group("/quality").text(attribute_sums_column));
}

struct KeepingAll {
  using Stream = RawStream;
  template <typename Row>
  using Rows = std::vector<Row>;
};
struct KeepingNothing {
  using Stream = PassedStream;
  template <typename Row>
  using Rows = PassedRows<Row>;
};

/// What grows with a recording.
template <typename Keeping>
struct Tables {
  PerDevice<typename Keeping::Stream> received, sent;
  typename Keeping::template Rows<TimedFrame> frames;
  typename Keeping::template Rows<TimedGyro> gyro;
  typename Keeping::template Rows<TimedServo> servo;
  typename Keeping::template Rows<TimedShaft> shaft;
  typename Keeping::template Rows<PingExchange> exchanges;
  typename Keeping::template Rows<LabelledSample> samples;
};

/// Reads, and checks, all that thermorig wrote.
template <typename Keeping>
Session read_whole(SessionFile& file, Tables<Keeping>& tables) {
  Session session = read_foundation(file);
  read_streams(file, session.raw.header.time_reference, tables.received, tables.sent);
  auto camera = file.group("/camera");
  camera_columns(camera, tables.frames);
  auto gyro = file.group("/gyro");
  gyro_columns(gyro, tables.gyro);
  auto servo = file.group("/servo");
  servo_columns(servo, tables.servo);
  if (!session.raw.header.shaft_sensor.empty()) {
    auto shaft = file.group("/shaft");
    shaft_columns(shaft, tables.shaft);
  }
  auto pings = file.group("/sync/servo");
  ping_columns(pings, tables.exchanges);
  if (file.version() >= with_sync_report) read_sync_tables(file, session.sync);
  read_samples(file, tables.frames.size(), tables.samples);
  check_copies(file);
  if (file.version() >= with_attribute_sums) file.group("/quality").text(attribute_sums_column);
  return session;
}

MessageMarks read_marks(const SessionFile& file) {
  MessageMarks marks;
  const auto self = [](auto& time) -> auto& {
    return time;
  };
  auto camera = file.group("/camera");
  camera.time_axis({"time"}, marks.frames, &FrameMark::time, frames_max);
  camera.column<std::int64_t>({"arrival_ns"}, marks.frames, nullptr,
                              [](FrameMark& frame, std::int64_t ns) { frame.arrival = host_time_ns(ns); });
  freshness_columns(camera, marks.frames);
  auto gyro = file.group("/gyro");
  gyro.time_axis({"time"}, marks.gyro, self);
  auto servo = file.group("/servo");
  servo.time_axis({"time"}, marks.servo, self);
  return marks;
}

Overview read_all_of_overview(SessionFile& file) {
  Session session = read_foundation(file);
  if (file.version() >= with_sync_report) read_sync_tables(file, session.sync);
  const MessageMarks marks = read_marks(file);
  read_samples(file, marks.frames.size(), session.samples);
  complete_labels(file.version(), session.samples);
  Quality quality = quality_of(session, marks);
  return {std::move(session), std::move(quality)};
}

void look_at_all(SessionFile& file) {
  Tables<KeepingNothing> tables;
  read_whole(file, tables);
}

Session read_all(SessionFile& file) {
  Tables<KeepingAll> tables;
  Session session = read_whole(file, tables);
  session.raw.received = std::move(tables.received);
  session.raw.sent = std::move(tables.sent);
  session.frames = std::move(tables.frames);
  session.gyro = std::move(tables.gyro);
  session.servo = std::move(tables.servo);
  session.shaft = std::move(tables.shaft);
  for (const PingExchange& exchange : tables.exchanges) session.pongs.push_back(exchange.pong);
  session.samples = std::move(tables.samples);
  complete_labels(file.version(), session.samples);
  return session;
}

RawRecording read_all_raw(SessionFile& file) {
  RawRecording raw = read_foundation(file).raw;
  read_streams(file, raw.header.time_reference, raw.received, raw.sent);
  return raw;
}

/// The verdict as it stands in the file: to find it anew takes all tables.
void read_verdict(const SessionFile& file, Rows& rows) {
  const std::string group = "/quality";
  for (const StoredAttribute& stored : stored_attributes(file.id(), group)) {
    if (stored.path() == "/quality@verdict" && stored.texts.size() == 1) rows.verdict = stored.texts.front();
    if (stored.path() == "/quality@verdict_reasons") rows.verdict_reasons = stored.texts;
  }
  if (file.version() < with_attribute_sums) return;
  const std::string sums = file.group(group).text(attribute_sums_column);
  for (const std::string& altered : altered_attributes(file.id(), group, sums))
    rows.verdict_altered = rows.verdict_altered || altered.starts_with("/quality@verdict");
}

Rows read_all_rows(SessionFile& file) {
  Rows rows;
  Session& session = rows.session;
  session = read_foundation(file);
  if (file.version() >= with_checked_constants) {
    auto sync = file.group("/sync");
    bias_columns(sync, session.sync.gyro.bias_course);
  }
  auto camera = file.group("/camera");
  rows.frames.resize(camera.count_rows("time", frames_max, sizeof(FrameMarks)));
  freshness_columns(camera, rows.frames);
  read_samples(file, rows.frames.size(), session.samples);
  complete_labels(file.version(), session.samples);
  read_verdict(file, rows);
  return rows;
}

Images read_some_images(SessionFile& file, FrameRange range) {
  auto camera = file.group("/camera");
  const std::uint64_t frames = camera.count_rows("time", frames_max, sizeof(ThermalFrame));
  if (range.first > frames || range.count > frames - range.first || range.count > most_images)
    refuse(file.path(), fmt::format("has no frames {} to {}", range.first, range.first + range.count));
  Images images{file.read_header().profile.camera.mirrored, std::vector<ThermalFrame>(range.count)};
  camera.block_range<float>(temperature_column, pixel_axes(camera), range.first, images.frames,
                            &ThermalFrame::temp_c);
  return images;
}

/// A count of a reason, or a reason of the verdict, that the file may have, and the one made of it need not.
bool is_of_its_quality(const StoredAttribute& stored) {
  return stored.object == "/quality" &&
         (stored.name.starts_with("reason_") || stored.name == "verdict_reasons");
}

/// A copy of the profile's, as sessions had them before format 2.0.
bool is_of_the_profile(const StoredAttribute& stored) {
  static const std::set<std::string, std::less<>> names{"model",
                                                        "port",
                                                        "usb_path",
                                                        "baud",
                                                        "latency_s",
                                                        "latency_uncertainty_s",
                                                        "latency_measured",
                                                        "output_rate_setting_hz",
                                                        "field_of_view_deg",
                                                        "mirrored",
                                                        "orientation_measured",
                                                        "checksum_policy",
                                                        "protocol",
                                                        "rate_setting_hz",
                                                        "axis_used",
                                                        "sign",
                                                        "scale",
                                                        "scale_uncertainty",
                                                        "scale_measured",
                                                        "bias_dps",
                                                        "bias_uncertainty_dps",
                                                        "bias_measured",
                                                        "firmware",
                                                        "kind",
                                                        "travel_deg",
                                                        "full_rate_dps",
                                                        "pulse_min_us",
                                                        "pulse_max_us",
                                                        "max_rate_dps",
                                                        "acceleration_dps2",
                                                        "stop_margin_deg",
                                                        "loop_hz"};
  if (stored.object == "/rig") return stored.name == "name";
  return (stored.object == "/camera" || stored.object == "/gyro" || stored.object == "/servo") &&
         names.contains(stored.name);
}

AddedByOthers read_added(SessionFile& file) {
  std::vector<StoredAttribute> attributes = stored_attributes(file.id());
  if (file.version() >= with_attribute_sums) {
    const std::string sums = file.group("/quality").text(attribute_sums_column);
    return {without_named(std::move(attributes), sums), objects_without_named(file.id(), sums)};
  }
  std::erase_if(attributes, is_of_its_quality);
  std::erase_if(attributes, is_of_the_profile);
  return {std::move(attributes), {}};
}

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

/// Who holds hdf5_turn() reads. `end`: of the file.
template <typename Read>
auto read_or_explain(const StoredFile& stored, std::uint64_t end, Read read) {
  DriverSource source{&stored, end, 0, nullptr};
  try {
    prepare_hdf5();
    const ClearedErrors cleared;
    SessionFile file(source);
    return read(file);
  } catch (const Hdf5Failure& failure) {
    if (source.failure) std::rethrow_exception(source.failure);
    refuse(stored.path(), failure.what());
  } catch (const std::bad_alloc&) {
    refuse(stored.path(), "claims to be larger than the memory of this computer");
  }
}

/// A child process first, if one tries files; it begins while no other thread is in the library.
template <typename Read>
void try_first(const StoredFile& stored, std::uint64_t end, Read read) {
  if (!are_sessions_tried()) return;
  std::unique_lock turn(hdf5_turn());
  Trial trial(stored, [&] { read_or_explain(stored, end, read); });
  turn.unlock();
  trial.require_good();
}

template <typename Read>
auto read_in_turn(const StoredFile& stored, std::uint64_t end, Read read) {
  const std::lock_guard turn(hdf5_turn());
  return read_or_explain(stored, end, read);
}

/// What reads a part of a session.
template <typename Read>
auto tried_and_read(const StoredFile& stored, Read read) {
  require_whole(stored);
  try_first(stored, stored.size(), read);
  return read_in_turn(stored, stored.size(), read);
}

}  // namespace

std::mutex& hdf5_turn() {
  static std::mutex turn;
  return turn;
}

Session read_session(const StoredFile& file) {
  require_whole(file);
  try_first(file, file.size(), look_at_all);
  return read_in_turn(file, file.size(), read_all);
}

Overview read_overview(const StoredFile& file) {
  require_readable(file);
  return read_in_turn(file, file.size(), read_all_of_overview);
}

Session read_session(const fs::path& path) {
  return read_session(StoredFile(path));
}

RawRecording read_raw(const fs::path& path) {
  const StoredFile file(path);
  require_whole(file);
  try_first(file, file.size(), look_at_all);
  return read_in_turn(file, file.size(), read_all_raw);
}

Rows read_rows(const StoredFile& file) {
  return tried_and_read(file, read_all_rows);
}

Images read_images(const StoredFile& file, FrameRange range) {
  return tried_and_read(file, [range](SessionFile& session) { return read_some_images(session, range); });
}

AddedByOthers added_by_others(const StoredFile& file) {
  return tried_and_read(file, read_added);
}

std::vector<std::string> altered_attributes(const StoredFile& file) {
  return tried_and_read(file, read_altered);
}

void require_readable(const StoredFile& file) {
  require_whole(file);
  if (are_sessions_tried()) return try_first(file, file.size(), look_at_all);
  read_in_turn(file, file.size(), look_at_all);
}

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
