// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <set>

#include "attributes.h"
#include "group_reader.h"
#include "message_marks.h"
#include "open_session.h"
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

/// What reads a part of a session.
template <typename Read>
auto tried_and_read(const StoredFile& stored, Read read) {
  require_whole(stored);
  try_first(stored, stored.size(), read);
  return read_in_turn(stored, stored.size(), read);
}

}  // namespace

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

}  // namespace thermorig::session
