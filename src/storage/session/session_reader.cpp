// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <mutex>
#include <optional>
#include <set>

#include "annotation_columns.h"
#include "attributes.h"
#include "estimate_columns.h"
#include "file_image.h"
#include "format.h"
#include "group_reader.h"
#include "message_marks.h"
#include "passed_rows.h"
#include "profile_attributes.h"
#include "recording_columns.h"
#include "sample_columns.h"
#include "scalars.h"
#include "sent_bytes.h"
#include "stored_attributes.h"
#include "sync_attributes.h"
#include "sync_columns.h"
#include "tasks.h"
#include "thermorig/core/error.h"
#include "thermorig/sensors/wire/counter_names.h"
#include "thermorig/storage/recording_header/header_json.h"
#include "thermorig/storage/sandbox/refusal.h"
#include "thermorig/storage/session/annotations.h"
#include "thermorig/storage/session/rows.h"
#include "thermorig/storage/session/salvage.h"
#include "thermorig/storage/session/session.h"
#include "thermorig/storage/session/trial.h"

namespace thermorig::session {

namespace {

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
  /// `bytes_there`: of a file that was cut short, behind which `copy` has zeros.
  explicit SessionFile(const sandbox::SealedCopy& copy, std::optional<std::uint64_t> bytes_there = {})
      : path_(copy.path()) {
    const fs::path& path = path_;
    facts_.copy = &copy;
    facts_.bytes = copy.bytes().size();
    facts_.bytes_there = bytes_there.value_or(facts_.bytes);
    if (copy.bytes().empty()) sandbox::refuse(path, "is empty");
    require_whole(copy);
    file_ = open_file_image(copy.bytes(), "open it as HDF5");
    require_nothing_behind();
    if (!has_attribute(id(), "format") || get_text_attribute(id(), "format") != format_name)
      sandbox::refuse(path, "is HDF5, but not a thermorig session");
    const std::string version = get_text_attribute(id(), "format_version");
    const auto known = version_of(version);
    if (!known)
      sandbox::refuse(
          path, fmt::format("is a session of format version {}, and this program reads versions {} to {}",
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
  void require_nothing_behind() const {
    const auto end = static_cast<std::uint64_t>(
        check(H5Fget_file_image(id(), nullptr, 0), "find its end"));  // its size as the file states it
    if (end < facts_.bytes)
      sandbox::refuse(path_,
                      fmt::format("ends after {} bytes, and {} more stand behind", end, facts_.bytes - end));
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
      sandbox::refuse(path_, "has an attribute `license` that is no line of up to 1000 bytes of UTF-8");
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
enum class Streams : std::uint8_t { read, left_out };

template <typename Stream>
void read_streams(const SessionFile& file, HostTime reference, PerDevice<Stream>& received,
                  PerDevice<Stream>& sent) {
  for (const Device device : all_devices)
    read_stream(file, std::string(name_of(device)), "arrival_ns", reference, received[device]);
  for (const Device device : all_devices)
    if (device == Device::servo || file.has_group("/raw/" + sent_group(device)))
      read_stream(file, sent_group(device), "sent_ns", reference, sent[device]);
}

RawRecording read_recording(SessionFile& file, Streams streams) {
  RawRecording raw;
  raw.header = file.read_header();
  if (streams == Streams::read) read_streams(file, raw.header.time_reference, raw.received, raw.sent);
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

template <typename Rows>
void read_exchanges(const SessionFile& file, Rows& exchanges) {
  auto group = file.group("/sync/servo");
  ping_columns(group, exchanges);
}

std::vector<TimedPong> read_pongs(const SessionFile& file) {
  std::vector<PingExchange> exchanges;
  read_exchanges(file, exchanges);
  std::vector<TimedPong> pongs;
  for (const auto& exchange : exchanges) pongs.push_back(exchange.pong);
  return pongs;
}

/// Before format 1.1 the label was the commanded speed, and there was no other.
void complete_labels_of_1_0(std::vector<LabelledSample>& samples) {
  constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
  for (LabelledSample& sample : samples) {
    sample.rate_commanded_dps = sample.rate_shaft_dps;
    sample.rate_shaft_half_dps = sample.rate_commanded_half_dps = {unknown, unknown};
    sample.rate_gyro_half_dps = {unknown, unknown};
    sample.gyro_spread_dps = unknown;
  }
}

void read_samples(const SessionFile& file, std::vector<LabelledSample>& samples) {
  auto group = file.group("/samples");
  sample_columns(group, samples);
  if (file.version() < with_sync_report) complete_labels_of_1_0(samples);
}

[[noreturn]] void refuse_samples() {
  throw Hdf5Failure("believe /samples/frame: the samples are not one a frame, in order");
}

/// Windows are neighbouring rows, so rows must be the frames one after the other.
void check_samples(const std::vector<LabelledSample>& samples, std::size_t frames) {
  bool good = samples.size() == frames;
  for (std::size_t row = 0; good && row < samples.size(); ++row) good = samples[row].frame_index == row;
  if (!good) refuse_samples();
}

void pass_samples(const SessionFile& file, std::size_t frames) {
  PassedRows<LabelledSample> samples;
  auto group = file.group("/samples");
  sample_columns(group, samples);
  std::uint64_t next = 0;
  group.column<std::uint32_t>({"frame"}, samples, nullptr, [&next](auto&, std::uint32_t frame) {
    if (frame != next++) refuse_samples();
  });
  if (samples.size() != frames) refuse_samples();
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
Session read_foundation(SessionFile& file, Streams streams = Streams::read) {
  Session session;
  session.raw = read_recording(file, streams);
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

template <typename Frames, typename Gyro, typename Servo>
void read_messages(const SessionFile& file, Frames& frames, Gyro& gyro_samples, Servo& telemetry) {
  auto camera = file.group("/camera");
  camera_columns(camera, frames);
  auto gyro = file.group("/gyro");
  gyro_columns(gyro, gyro_samples);
  auto servo = file.group("/servo");
  servo_columns(servo, telemetry);
}

/// All that read_all() checks, row by row: nothing of it is kept.
void pass_all(SessionFile& file) {
  Session session = read_foundation(file, Streams::left_out);
  PerDevice<PassedStream> received, sent;
  read_streams(file, session.raw.header.time_reference, received, sent);
  PassedRows<TimedFrame> frames;
  PassedRows<TimedGyro> gyro;
  PassedRows<TimedServo> servo;
  read_messages(file, frames, gyro, servo);
  PassedRows<PingExchange> exchanges;
  read_exchanges(file, exchanges);
  if (file.version() >= with_sync_report) read_sync_tables(file, session.sync);
  pass_samples(file, frames.size());
  check_copies(file);
  if (file.version() >= with_attribute_sums) file.group("/quality").text(attribute_sums_column);
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
  Session session = read_foundation(file, Streams::left_out);
  if (file.version() >= with_sync_report) read_sync_tables(file, session.sync);
  read_samples(file, session.samples);
  Quality quality = quality_of(session, read_marks(file));
  return {std::move(session), std::move(quality)};
}

Session read_all(SessionFile& file) {
  Session session = read_foundation(file);
  read_messages(file, session.frames, session.gyro, session.servo);
  session.pongs = read_pongs(file);
  if (file.version() >= with_sync_report) read_sync_tables(file, session.sync);
  read_samples(file, session.samples);
  check_samples(session.samples, session.frames.size());
  check_copies(file);
  if (file.version() >= with_attribute_sums) file.group("/quality").text(attribute_sums_column);
  return session;
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
  session = read_foundation(file, Streams::left_out);
  if (file.version() >= with_checked_constants) {
    auto sync = file.group("/sync");
    bias_columns(sync, session.sync.gyro.bias_course);
  }
  read_samples(file, session.samples);
  auto camera = file.group("/camera");
  rows.frames.resize(camera.count_rows("time", frames_max, sizeof(FrameMarks)));
  freshness_columns(camera, rows.frames);
  check_samples(session.samples, rows.frames.size());
  read_verdict(file, rows);
  return rows;
}

Images read_some_images(SessionFile& file, FrameRange range) {
  auto camera = file.group("/camera");
  const std::uint64_t frames = camera.count_rows("time", frames_max, sizeof(ThermalFrame));
  if (range.first > frames || range.count > frames - range.first || range.count > most_images)
    sandbox::refuse(file.path(),
                    fmt::format("has no frames {} to {}", range.first, range.first + range.count));
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

std::mutex hdf5_turn;  // the library may be in one thread at a time

template <typename Read>
auto read_or_explain(const sandbox::SealedCopy& copy, Read read,
                     std::optional<std::uint64_t> bytes_there = {}) {
  const std::lock_guard turn(hdf5_turn);
  try {
    prepare_hdf5();
    const ClearedErrors cleared;
    SessionFile file(copy, bytes_there);
    return read(file);
  } catch (const Hdf5Failure& failure) {
    sandbox::refuse(copy.path(), failure.what());
  } catch (const std::bad_alloc&) {
    sandbox::refuse(copy.path(), "claims to be larger than the memory of this computer");
  }
}

}  // namespace

Session read_session(const sandbox::SealedCopy& copy) {
  return read_or_explain(copy, read_all);
}

Overview read_overview(const sandbox::SealedCopy& copy) {
  require_readable(copy);
  return read_or_explain(copy, read_all_of_overview);
}

Session read_session(const fs::path& path) {
  return read_session(tried_copy(path));
}

RawRecording read_raw(const fs::path& path) {
  return read_or_explain(tried_copy(path), [](SessionFile& file) { return read_foundation(file); }).raw;
}

Rows read_rows(const sandbox::SealedCopy& copy) {
  return read_or_explain(copy, read_all_rows);
}

Images read_images(const sandbox::SealedCopy& copy, FrameRange range) {
  return read_or_explain(copy, [range](SessionFile& file) { return read_some_images(file, range); });
}

AddedByOthers added_by_others(const sandbox::SealedCopy& copy) {
  return read_or_explain(copy, read_added);
}

std::vector<std::string> altered_in(const sandbox::SealedCopy& copy) {
  return read_or_explain(copy, read_altered);
}

Salvaged salvaged_from(const sandbox::SealedCopy& padded, std::uint64_t bytes_there) {
  return read_or_explain(padded, read_salvaged, bytes_there);
}

void read_for_nothing(const sandbox::SealedCopy& copy) {
  read_or_explain(copy, pass_all);
}

}  // namespace thermorig::session
