// SPDX-License-Identifier: MIT
#include "session_image.h"

#include <fmt/format.h>
#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <limits>
#include <new>

#include "attributes.h"
#include "chunk_codec.h"
#include "chunk_writer.h"
#include "estimate_columns.h"
#include "file_driver.h"
#include "format.h"
#include "group_writer.h"
#include "hdf5_handle.h"
#include "profile_attributes.h"
#include "recording_columns.h"
#include "sample_columns.h"
#include "scalars.h"
#include "sent_bytes.h"
#include "sync_attributes.h"
#include "sync_columns.h"
#include "thermorig/core/validity.h"
#include "thermorig/sensors/wire/counter_names.h"
#include "thermorig/storage/session/annotations.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::session {

namespace {

std::uint8_t flag(bool value) {
  return value ? 1 : 0;
}

/// Writes what sync_attributes.h lists.
struct AttributeWriter {
  hid_t group;
  void operator()(const char* name, const std::string& value) { set_attribute(group, name, value); }
  void operator()(const char* name, double value) { set_attribute(group, name, value); }
  void operator()(const char* name, std::uint32_t value) { set_attribute(group, name, value); }
  void operator()(const char* name, bool value) { set_attribute(group, name, flag(value)); }
  void operator()(const char* name, const std::optional<double>& value) {
    set_attribute(group, name, value.value_or(std::numeric_limits<double>::quiet_NaN()));
  }
};

/// How hard the scene is for the camera: the order of contrast in the environments of the published rig.
const char* difficulty_of(const std::string& environment) {
  if (environment == "laboratory") return "low";
  if (environment == "dining" || environment == "kitchen") return "medium";
  if (environment == "garden") return "high";
  return "unknown";
}

std::string hdf5_version() {
  unsigned major = 0, minor = 0, release = 0;
  check(H5get_libversion(&major, &minor, &release), "tell the version of HDF5");
  return fmt::format("{}.{}.{}", major, minor, release);
}

void write_simulation(hid_t root, const RecordingHeader& header) {
  set_attribute(root, "simulated", flag(header.simulated));
  if (header.simulation_seed) set_attribute(root, "simulation_seed", *header.simulation_seed);
  if (header.simulated) set_attribute(root, "simulation", header.simulation);
}

void write_stream(hid_t group, const std::string& name, const Quality::Stream& stream) {
  const auto set = [&](const char* what, auto value) { set_attribute(group, (name + what).c_str(), value); };
  set("_received", stream.received);
  set("_lost", stream.lost);
  set("_bad", stream.bad);
  set("_repeated", stream.repeated);
  set("_rate_min_hz", stream.rate_min_hz);
  set("_rate_mean_hz", stream.rate_mean_hz);
  set("_rate_max_hz", stream.rate_max_hz);
  set("_gap_max_s", stream.gap_max_s);
}

void write_sync_quality(hid_t group, const Quality& quality) {
  for (const Device device : all_devices) {
    const std::string name(thermorig::name_of(device));
    set_attribute(group, (name + "_clock_uncertainty_s").c_str(), quality.clock[device].uncertainty_s);
    set_attribute(group, (name + "_clock_bound_s").c_str(), quality.clock[device].bound_s);
  }
  const Estimate unknown{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  const Estimate offset = quality.camera_offset_s.value_or(unknown);
  set_attribute(group, "camera_offset_s", offset.value);
  set_attribute(group, "camera_offset_uncertainty_s", offset.uncertainty);
  set_attribute(group, "rate_shaft_uncertainty_dps", quality.rate_shaft_uncertainty_dps);
  set_attribute(group, "gyro_residual_dps", quality.gyro_residual_dps);
}

void write_root_attributes(hid_t root, const Session& session) {
  const auto& header = session.raw.header;
  const double duration_s = to_s(session.raw.end_time - header.time_reference);
  set_attribute(root, "NX_class", "NXroot");
  set_attribute(root, "default", "samples");
  set_attribute(root, "format", format_name);
  set_attribute(root, "format_version", format_version.text() + ".0");
  set_attribute(root, "uuid", header.uuid);
  set_attribute(root, "title", header.title);
  set_attribute(root, "start_time", header.start_time_utc);
  set_attribute(root, "end_time", utc_after(header.start_time_utc, duration_s));
  set_attribute(root, "time_reference", header.start_time_utc);
  set_attribute(root, "time_reference_ns", to_ns(header.time_reference));
  set_attribute(root, "end_time_ns", to_ns(session.raw.end_time));
  set_attribute(root, "timezone", "UTC");
  set_attribute(root, "duration_s", duration_s);
  set_attribute(root, "state", name_of(session.state));
  set_attribute(root, "closed_by_recorder", flag(session.raw.complete));
  write_simulation(root, header);
  set_attribute(root, "creator", header.creator);
  set_attribute(root, "creator_git", header.creator_git);
  set_attribute(root, "host_name", header.host_name);
  set_attribute(root, "kernel", header.kernel);
  set_attribute(root, "HDF5_Version", hdf5_version());
  set_attribute(root, "Conventions", "CF-1.10");
  if (!header.operator_name.empty()) set_attribute(root, "operator", header.operator_name);
  if (!header.note.empty()) set_attribute(root, "note", header.note);
  set_attribute(root, "license", header.licence.empty() ? licence_not_stated : header.licence);
  set_attribute(root, "scalars_crc32", scalars_crc32(session, header_text(header), format_version));
}

void write_camera_attributes(hid_t group, const Session& session) {
  set_attribute(group, "mode", session.camera_mode);
  set_attribute(group, "frame_period_s", session.frame_period_s);
}

void write_sync_attributes(hid_t group, const Session& session) {
  set_attribute(group, "method", "one-way and two-way bounds of each device's clock, minus its latency");
  set_attribute(group, "host_clock", "CLOCK_MONOTONIC");
  set_attribute(group, "realtime_offset_ns", session.raw.header.realtime_offset_ns);
  AttributeWriter writer{group};
  sync_attributes(writer, session.sync, format_version);
}

void write_clock_attributes(hid_t group, const ClockReport& clock) {
  AttributeWriter writer{group};
  clock_attributes(writer, clock, format_version);
}

void write_samples_attributes(hid_t group, const Session& session) {
  plot_as(group, "rate_shaft", {"time"}, {"rate_gyro"});
  set_attribute(group, "label_version", "3");
  const bool has_servo = session.raw.header.profile.servo.is_there();
  set_attribute(group, "label_source", has_servo ? "command" : "gyro");
  set_attribute(
      group, "label_rule",
      !has_servo ? "rate_shaft: mean rate of the gyro over the exposure of both halves of the "
                   "frame, less its bias, over its scale; nothing was commanded"
                 : "rate_commanded: mean speed of the servo's pulses over the exposure of both halves of the "
                   "frame; rate_corrected: the same, corrected by what the session measured of the servo; "
                   "rate_shaft: mean speed of the shaft by the servo model over the same exposure");
  set_attribute(group, "settle_s", session.settle_s);
}

void write_estimates_attributes(hid_t group, const Session& session) {
  const LiveModel& model = session.raw.header.live_model;
  plot_as(group, "rate", {"time", "estimator"}, {"rate_commanded"});
  set_attribute(group, "model", model.name);
  set_attribute(group, "model_hash", model.hash);
  set_attribute(group, "model_frames", model.frames);
  set_attribute(group, "model_reduction", model.reduction);
  set_attribute(group, "model_fusion", flag(model.fusion));
  set_attribute(group, "model_simulated", flag(model.simulated));
  set_attribute(group, "label_scale_dps", model.label_scale_dps);
  set_attribute(group, "model_precision", model.precision);
  set_attribute(group, "model_turned", model.turned);
}

void write_environment_attributes(hid_t group, const Session& session) {
  const auto& header = session.raw.header;
  set_attribute(group, "NX_class", "NXenvironment");
  const Place place = place_of(session);
  set_attribute(group, "name", place.environment);
  set_attribute(group, "difficulty", difficulty_of(place.environment));
  set_attribute(group, "acquisition_number", place.acquisition);
  if (!header.place.empty()) set_attribute(group, "place", header.place);
}

void write_rig_attributes(hid_t group, const Session& session) {
  const auto& header = session.raw.header;
  set_attribute(group, "plan_name", header.plan_name);
  set_attribute(group, "frames_per_leg", header.frames_per_leg);
  set_attribute(group, "firmware", header.firmware);
}

void write_raw_attributes(hid_t group, const wire::Counters& counters) {
  for (const auto& counter : wire::counter_names)
    set_attribute(group, counter.name, counters.*counter.member);
}

void write_quality_attributes(hid_t group, const Quality& quality) {
  for (const Device device : all_devices)
    write_stream(group, std::string(thermorig::name_of(device)), quality.stream[device]);
  set_attribute(group, "duration_s", quality.duration_s);
  set_attribute(group, "frames", quality.frames);
  set_attribute(group, "frames_swept", quality.swept);
  set_attribute(group, "frames_valid", quality.valid);
  for (const auto& [reason, count] : quality.reason_counts)
    set_attribute(group, ("reason_" + reason).c_str(), count);
  write_sync_quality(group, quality);
  set_attribute(group, "verdict", quality.verdict);
  set_attribute(group, "verdict_reasons", quality.verdict_reasons);
  set_attribute(group, "check_version", "2");
}

/// The library fills each step with zeros; more at once would be a large array for the smallest session.
constexpr std::size_t step_bytes = 1U << 20U;

/// Stands before the file: a file that grows by small steps is not copied at each.
struct Front {
  std::size_t capacity = 0;
  alignas(std::max_align_t) std::byte file[1];
};
constexpr std::size_t front_bytes = offsetof(Front, file);

Front* front_of(void* file) {
  return reinterpret_cast<Front*>(static_cast<std::byte*>(file) - front_bytes);
}

void* allocate(std::size_t bytes, H5FD_file_image_op_t /*why*/, void* /*data*/) {
  void* const at = ::operator new(front_bytes + bytes, std::nothrow);
  return at == nullptr ? nullptr : (new (at) Front{bytes, {}})->file;
}

void* copy(void* to, const void* from, std::size_t bytes, H5FD_file_image_op_t /*why*/, void* /*data*/) {
  return std::memcpy(to, from, bytes);
}

herr_t release(void* file, H5FD_file_image_op_t /*why*/, void* /*data*/) {
  if (file != nullptr) ::operator delete(front_of(file));
  return 0;
}

void* resize(void* file, std::size_t bytes, H5FD_file_image_op_t why, void* data) {
  if (file == nullptr) return allocate(bytes, why, data);
  const std::size_t capacity = front_of(file)->capacity;
  if (bytes <= capacity) return file;
  void* const grown = allocate(std::max(bytes, capacity + capacity / 2), why, data);
  if (grown == nullptr) return nullptr;
  std::memcpy(grown, file, capacity);
  release(file, why, data);
  return grown;
}

/// Properties of access to a file that HDF5 builds in memory from `new`, as all large arrays are: HDF5's own
/// would come from malloc(), and always be memory. Throws Hdf5Failure.
Handle access_in_memory() {
  Handle access(H5Pcreate(H5P_FILE_ACCESS), "make properties");
  check(H5Pset_fapl_core(access.get(), step_bytes, false), "build the file in memory");
  H5FD_file_image_callbacks_t memory{allocate, copy, resize, release, nullptr, nullptr, nullptr};
  check(H5Pset_file_image_callbacks(access.get(), &memory), "build the file in memory");
  return access;
}

constexpr std::size_t crc_part_bytes = 4U << 20U;

Handle create_in_memory() {
  const Handle access = access_in_memory();
  const Handle creation(H5Pcreate(H5P_FILE_CREATE), "make properties");
  check(H5Pset_link_creation_order(creation.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED),
        "track the order of creation");
  check(H5Pset_obj_track_times(creation.get(), false), "switch object times off");
  // The name is never used, but looked up: this one cannot exist.
  return Handle(H5Fcreate("/dev/null/session", H5F_ACC_TRUNC, creation.get(), access.get()),
                "build the file in memory");
}

/// Where the library itself keeps it: a copy would take as much memory again.
std::span<const std::byte> image_of(hid_t file) {
  check(H5Fflush(file, H5F_SCOPE_GLOBAL), "finish the file");
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  void** memory = nullptr;
  check(H5Fget_vfd_handle(file, H5P_DEFAULT, reinterpret_cast<void**>(&memory)), "finish the file");
  if (size <= 0 || memory == nullptr || *memory == nullptr) throw Hdf5Failure("finish the file");
  return {static_cast<const std::byte*>(*memory), static_cast<std::size_t>(size)};
}

/// Writes the groups one after another; what the chunk writer still needs lives as long as this.
class ImageBuilder {
 public:
  ImageBuilder(const Session& session, unsigned threads)
      : session_(session),
        file_(create_in_memory()),
        exchanges_(ping_exchanges(session.pongs, session.raw.sent[Device::servo])),
        commands_(timed_commands(session.raw.sent[Device::servo])),
        quality_(quality_of(session)),
        chunks_(threads) {}

  SessionImage build(const std::vector<StoredAttribute>& added) {
    write_root_attributes(file_.get(), session_);
    make_groups();
    // First what all the rest can be made of again, so that it is in whatever a cut copy still holds; and
    // the camera, most of it, last: its first frames are of use if everything else is there.
    if (!session_.annotations.empty()) write_annotations();
    write_events();
    write_sent();
    write_received(Device::servo);
    write_received(Device::gyro);
    write_servo();
    if (has_shaft()) write_shaft();
    write_received(Device::camera);
    write_camera();
    write_gyro();
    write_sync();
    write_samples();
    if (!session_.raw.estimates.empty()) write_estimates();
    write_texts();
    auto quality = write_quality();
    // Else the library may give what describes the groups its place at the end, behind all values.
    check(H5Fflush(file_.get(), H5F_SCOPE_GLOBAL), "lay out the file");
    SessionImage image;
    image.datasets = chunks_.finish();
    quality.text(attribute_sums_column, attribute_sums(stored_attributes(file_.get())));
    add_attributes(file_.get(), added);
    image.bytes = image_of(file_.get());
    image.crc = libdeflate_crc32(0, image.bytes.data(), image.bytes.size());
    image.file = std::move(file_);
    return image;
  }

 private:
  /// In the order in which people look for them, which viewers show.
  void make_groups() {
    for (const char* path : {"/camera", "/gyro", "/servo"}) group(path);
    if (has_shaft()) group("/shaft");
    for (const char* path : {"/sync", "/samples"}) group(path);
    if (!session_.raw.estimates.empty()) group("/estimates");
    group("/events");
    if (!session_.annotations.empty()) group("/annotations");
    for (const char* path : {"/environment", "/rig", "/quality", "/raw"}) group(path);
  }

  GroupWriter group(const char* path) {
    return GroupWriter(file_.get(), path, chunks_, session_.raw.header.time_reference);
  }

  bool has_shaft() const { return !session_.raw.header.shaft_sensor.empty(); }

  void write_camera() {
    auto camera = group("/camera");
    plot_as(camera.id(), "temperature", {"time", "row", "column"});
    write_camera_attributes(camera.id(), session_);
    camera_columns(camera, session_.frames);
    camera.set_image("temperature");
  }

  void write_gyro() {
    auto gyro = group("/gyro");
    plot_as(gyro.id(), "rate", {"time"});
    gyro_columns(gyro, session_.gyro);
  }

  void write_servo() {
    auto servo = group("/servo");
    plot_as(servo.id(), "rate_commanded", {"time"});
    servo_columns(servo, session_.servo);
    step_columns(servo, session_.raw.legs);
    command_columns(servo, commands_);
  }

  void write_shaft() {
    auto shaft = group("/shaft");
    plot_as(shaft.id(), "angle", {"time"});
    set_attribute(shaft.id(), "sensor", session_.raw.header.shaft_sensor);
    shaft_columns(shaft, session_.shaft);
  }

  void write_sync() {
    auto sync = group("/sync");
    write_sync_attributes(sync.id(), session_);
    response_columns(sync, session_.sync.servo);
    bias_columns(sync, session_.sync.gyro.bias_course);
    for (const Device device : all_devices) {
      const ClockReport& clock = session_.sync.clock[device];
      auto group_of_device = group(("/sync/" + std::string(name_of(device))).c_str());
      write_clock_attributes(group_of_device.id(), clock);
      if (device == Device::servo) ping_columns(group_of_device, exchanges_);
      clock_columns(group_of_device, clock);
    }
  }

  void write_samples() {
    auto samples = group("/samples");
    write_samples_attributes(samples.id(), session_);
    sample_columns(samples, session_.samples);
    samples.set_computed_mask("reason_bits", computed_bits);
  }

  void write_estimates() {
    auto estimates = group("/estimates");
    write_estimates_attributes(estimates.id(), session_);
    estimate_row_columns(estimates, session_.raw.estimates);
    estimate_columns_by_name(estimates, session_.raw.estimates, EstimateAxes(session_.raw.header.estimators));
    estimates.set_computed_mask("reason_bits", computed_bits);
  }

  void write_events() {
    auto events = group("/events");
    event_columns(events, session_.raw.events);
  }

  void write_annotations() {
    auto annotations = group("/annotations");
    annotation_columns(annotations, session_.annotations);
  }

  void write_texts() {
    const auto& header = session_.raw.header;
    write_environment_attributes(group("/environment").id(), session_);
    auto rig = group("/rig");
    write_rig_attributes(rig.id(), session_);
    set_attribute(rig.id(), "header_json", header_text(header));
    write_profile([this](const std::string& path) { return group(path.c_str()); }, header.profile);
    rig.text(plan_column, header.plan_toml);
  }

  /// Stays open for what is known at the end alone.
  GroupWriter write_quality() {
    auto quality = group("/quality");
    write_quality_attributes(quality.id(), quality_);
    speed_columns(quality, quality_.speeds);
    return quality;
  }

  void write_received(Device device) {
    auto raw = group(("/raw/" + std::string(name_of(device))).c_str());
    write_raw_attributes(raw.id(), session_.counters[device]);
    raw_columns(raw, session_.raw.received[device], "arrival_ns", "host clock when read() returned [ns]",
                nullptr, nullptr);
  }

  void write_sent() {
    for (const Device device : all_devices) {
      const RawStream& stream = session_.raw.sent[device];
      if (device != Device::servo && stream.chunk_count() == 0) continue;
      auto sent = group(("/raw/" + sent_group(device)).c_str());
      raw_columns(sent, stream, "sent_ns", "host clock before write() was called [ns]", nullptr, nullptr);
    }
  }

  const Session& session_;
  Handle file_;
  std::vector<PingExchange> exchanges_;
  std::vector<TimedCommand> commands_;
  Quality quality_;
  ChunkWriter chunks_;
};

void check_dataset(hid_t file, const StoredDataset& stored) {
  const Handle dataset(H5Dopen2(file, stored.path.c_str(), H5P_DEFAULT), "open " + stored.path);
  const Handle space(H5Dget_space(dataset.get()), "read the shape of " + stored.path);
  std::array<hsize_t, H5S_MAX_RANK> dims{};
  check(H5Sget_simple_extent_dims(space.get(), dims.data(), nullptr), "read the shape of " + stored.path);
  if (dims[0] != stored.rows) throw Hdf5Failure("find all rows of " + stored.path);
  std::vector<std::byte> chunk;
  std::array<hsize_t, 3> offset{};
  for (const std::uint32_t crc : stored.chunk_crc) {
    hsize_t size = 0;
    std::uint32_t mask = 0;
    check(H5Dget_chunk_storage_size(dataset.get(), offset.data(), &size), "find a chunk of " + stored.path);
    chunk.resize(size);
    check(H5Dread_chunk(dataset.get(), H5P_DEFAULT, offset.data(), &mask, chunk.data()),
          "read " + stored.path);
    if (mask != 0 || libdeflate_crc32(0, chunk.data(), chunk.size()) != crc)
      throw Hdf5Failure("read back what was written to " + stored.path);
    offset[0] += stored.chunk_rows;
  }
}

std::uint32_t crc_of(const StoredFile& file) {
  std::uint32_t crc = 0;
  std::vector<std::byte> part(std::min<std::uint64_t>(crc_part_bytes, file.size()));
  for (std::uint64_t offset = 0; offset < file.size(); offset += part.size()) {
    part.resize(std::min<std::uint64_t>(part.size(), file.size() - offset));
    file.read(offset, part);
    crc = libdeflate_crc32(crc, part.data(), part.size());
  }
  return crc;
}

}  // namespace

void SessionImage::release() {
  const std::lock_guard turn(hdf5_turn());
  bytes = {};
  file.close("close the file in memory");
}

SessionImage build_image(const Session& session, unsigned threads,
                         const std::vector<StoredAttribute>& added) {
  const std::lock_guard turn(hdf5_turn());
  prepare_hdf5();
  return ImageBuilder(session, threads).build(added);
}

void check_written(const StoredFile& written, const SessionImage& meant) {
  if (crc_of(written) != meant.crc) throw Hdf5Failure("read back what was written");
  const std::lock_guard turn(hdf5_turn());
  prepare_hdf5();
  DriverSource source{&written, written.size(), 0, nullptr};
  Handle file = open_to_read(source, "open the written file");
  for (const auto& dataset : meant.datasets) check_dataset(file.get(), dataset);
  file.close("close the written file");
}

}  // namespace thermorig::session
