// SPDX-License-Identifier: MIT
#include "session_image.h"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "annotation_columns.h"
#include "attributes.h"
#include "chunk_codec.h"
#include "chunk_writer.h"
#include "estimate_columns.h"
#include "file_driver.h"
#include "group_attributes.h"
#include "group_writer.h"
#include "image_memory.h"
#include "profile_attributes.h"
#include "recording_columns.h"
#include "sample_columns.h"
#include "scalars.h"
#include "sent_bytes.h"
#include "sync_columns.h"

namespace thermorig::session {

namespace {

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
    for (const char* path : {"/camera", "/gyro", "/servo", "/sync", "/samples"}) group(path);
    if (!session_.raw.estimates.empty()) group("/estimates");
    group("/events");
    if (!session_.annotations.empty()) group("/annotations");
    for (const char* path : {"/environment", "/rig", "/quality", "/raw"}) group(path);
  }

  GroupWriter group(const char* path) {
    return GroupWriter(file_.get(), path, chunks_, session_.raw.header.time_reference);
  }

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
