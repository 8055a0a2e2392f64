// SPDX-License-Identifier: MIT
#pragma once

#include <hdf5.h>
#include <libdeflate.h>

#include <filesystem>
#include <string>
#include <utility>

#include "storage/session/attributes.h"
#include "storage/session/format.h"
#include "storage/session/hdf5_handle.h"
#include "storage/session/scalars.h"
#include "storage/session/stored_attributes.h"
#include "support/format_1_header.h"
#include "unchecked_file.h"

namespace thermorig::session {

/// A session file that is changed in place.
class EditedFile {
 public:
  explicit EditedFile(const std::filesystem::path& path)
      : file_(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "open it again") {}

  hid_t id() const { return file_.get(); }

  /// An attribute, whether it is there or not.
  template <typename Value>
  void replace(const std::string& path, const char* name, const Value& value) const {
    const Handle object = open(path);
    if (has_attribute(object.get(), name)) check(H5Adelete(object.get(), name), "remove an attribute");
    set_attribute(object.get(), name, value);
  }

  void replace_text(const std::string& path, const std::string& text) const {
    const Handle dataset = open(path);
    const char* const start = text.c_str();
    check(H5Dwrite(dataset.get(), text_type().get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, &start), "write text");
    replace(path, "crc32", libdeflate_crc32(0, start, text.size() + 1));
  }

  /// As a forger would: no attribute differs from its check sum.
  void renew_sums() const {
    auto attributes = stored_attributes(id());
    std::erase_if(attributes, [](const auto& stored) { return stored.object == "/quality/attribute_crc32"; });
    replace_text("/quality/attribute_crc32", attribute_sums(attributes));
  }

 private:
  Handle open(const std::string& path) const {
    return Handle(H5Oopen(id(), path.c_str(), H5P_DEFAULT), "open " + path);
  }

  Handle file_;
};

inline void remove_later_labels(hid_t file) {
  for (const char* name :
       {"rate_commanded_uncertainty", "rate_corrected", "rate_corrected_half", "rate_corrected_uncertainty",
        "angle_measured", "rate_measured", "rate_measured_half", "rate_measured_uncertainty"})
    check(H5Ldelete(file, ("/samples/" + std::string(name)).c_str(), H5P_DEFAULT), "remove a column");
}

/// Makes a file of format 1.3 of one that is written now: the profile in the header, as a text, and as
/// attributes of the devices' groups.
class Format1File {
 public:
  Format1File(const std::filesystem::path& path, const Session& session)
      : profile_(session.raw.header.profile), file_(path) {
    check(H5Ldelete(file_.id(), "/rig/profile", H5P_DEFAULT), "remove the profile");
    move_profile();
    remove_later_labels(file_.id());
    rename_by_shaft();
    const std::string header = tests::format_1_header(session.raw.header);
    replace("/rig", "header_json", header);
    replace("/", "format_version", "1.3.0");
    replace("/", "scalars_crc32", scalars_crc32(session, header, {1, 3}));
    file_.renew_sums();
  }

 private:
  template <typename Value>
  void replace(const std::string& path, const char* name, const Value& value) const {
    file_.replace(path, name, value);
  }

  void move_link(const char* group, const std::string& model, const PortProfile& link) const {
    replace(group, "model", model);
    replace(group, "port", link.port);
    replace(group, "usb_path", link.usb_path);
    replace(group, "baud", link.baud);
    replace(group, "latency_s", link.latency_s);
    replace(group, "latency_uncertainty_s", link.latency_uncertainty_s);
    replace(group, "latency_measured", link.latency_measured_utc);
  }

  void move_profile() const {
    replace("/rig", "name", profile_.name);
    move_camera();
    move_gyro();
    move_servo();
    const Handle scalar(H5Screate(H5S_SCALAR), "make a dataspace");
    Handle(H5Dcreate2(file_.id(), "/rig/profile_toml", text_type().get(), scalar.get(), H5P_DEFAULT,
                      H5P_DEFAULT, H5P_DEFAULT),
           "create a text")
        .close("close a text");
    file_.replace_text("/rig/profile_toml", "name = \"rig\"\n");
  }

  void rename_by_shaft() const {
    const std::pair<const char*, const char*> names[] = {
        {"rate_shaft", "rate_label"},         {"rate_shaft_min", "rate_label_min"},
        {"rate_shaft_max", "rate_label_max"}, {"rate_shaft_half", "rate_label_half"},
        {"angle_commanded", "angle_label"},   {"rate_shaft_uncertainty", "label_uncertainty"}};
    const Handle samples(H5Gopen2(file_.id(), "/samples", H5P_DEFAULT), "open the samples");
    for (const auto& [now, before] : names)
      check(H5Lmove(samples.get(), now, samples.get(), before, H5P_DEFAULT, H5P_DEFAULT), "rename a column");
    check(H5Arename_by_name(file_.id(), "/sync", "gyro_residual_dps", "label_residual_dps", H5P_DEFAULT),
          "rename an attribute");
  }

  void move_camera() const {
    const CameraProfile& camera = profile_.camera;
    move_link("/camera", camera.model, camera.link);
    replace("/camera", "output_rate_setting_hz", camera.output_rate_hz);
    replace("/camera", "field_of_view_deg", camera.field_of_view_deg);
    replace("/camera", "mirrored", static_cast<std::uint8_t>(camera.mirrored));
    replace("/camera", "orientation_measured", camera.orientation_measured_utc);
    replace("/camera", "checksum_policy", "word");
  }

  void move_gyro() const {
    const GyroProfile& gyro = profile_.gyro;
    move_link("/gyro", gyro.model, gyro.link);
    replace("/gyro", "protocol", gyro.protocol);
    replace("/gyro", "rate_setting_hz", gyro.output_rate_hz);
    replace("/gyro", "axis_used", gyro.axis);
    replace("/gyro", "sign", gyro.sign);
    replace("/gyro", "scale", gyro.scale);
    replace("/gyro", "scale_uncertainty", gyro.scale_uncertainty);
    replace("/gyro", "scale_measured", gyro.scale_measured_utc);
    replace("/gyro", "bias_dps", gyro.bias_dps);
    replace("/gyro", "bias_uncertainty_dps", gyro.bias_uncertainty_dps);
    replace("/gyro", "bias_measured", gyro.bias_measured_utc);
  }

  void move_servo() const {
    const ServoProfile& servo = profile_.servo;
    move_link("/servo", servo.model, servo.link);
    replace("/servo", "kind", "positional");
    replace("/servo", "travel_deg", servo.travel_deg);
    replace("/servo", "full_rate_dps", servo.full_rate_dps);
    replace("/servo", "pulse_min_us", servo.pulse_min_us);
    replace("/servo", "pulse_max_us", servo.pulse_max_us);
    replace("/servo", "max_rate_dps", servo.max_rate_dps);
    replace("/servo", "acceleration_dps2", servo.acceleration_dps2);
    replace("/servo", "stop_margin_deg", servo.stop_margin_deg);
    replace("/servo", "loop_hz", servo.loop_hz);
    replace("/servo", "scale", servo.scale);
    replace("/servo", "scale_uncertainty", servo.scale_uncertainty);
    replace("/servo", "scale_measured", servo.scale_measured_utc);
  }

  const RigProfile& profile_;
  EditedFile file_;
};

/// What came with the corrected label, and with the measured one.
inline void forget_later_labels(Session& session) {
  const LabelledSample nothing;
  for (LabelledSample& sample : session.samples) {
    sample.rate_commanded_uncertainty_dps = nothing.rate_commanded_uncertainty_dps;
    sample.rate_corrected_dps = nothing.rate_corrected_dps;
    sample.rate_corrected_half_dps = nothing.rate_corrected_half_dps;
    sample.rate_corrected_uncertainty_dps = nothing.rate_corrected_uncertainty_dps;
    sample.angle_measured_deg = nothing.angle_measured_deg;
    sample.rate_measured_dps = nothing.rate_measured_dps;
    sample.rate_measured_half_dps = nothing.rate_measured_half_dps;
    sample.rate_measured_uncertainty_dps = nothing.rate_measured_uncertainty_dps;
  }
}

/// What a file of format 1 can hold of a session.
inline Session format_1_session(Session session) {
  forget_later_labels(session);
  RigProfile& profile = session.raw.header.profile;
  profile = tests::format_1_profile(profile);
  GyroErrors& gyro = session.sync.gyro;
  const GyroErrors standard;
  gyro.scale_by_turns = standard.scale_by_turns;
  gyro.scale_why_not = standard.scale_why_not;
  gyro.decay_per_s = standard.decay_per_s;
  session.sync.bad_pixels.clear();
  gyro.filter_delay_s = standard.filter_delay_s;
  gyro.filter_source = standard.filter_source;
  gyro.scale_contradicts = gyro.filter_contradicts = false;
  gyro.bias_course.clear();
  for (const Device device : all_devices) {
    session.sync.clock[device].bound_wander_ppm = ClockReport().bound_wander_ppm;
    session.sync.clock[device].needed_wander_ppm = ClockReport().needed_wander_ppm;
    session.sync.clock[device].own_time_unused.clear();
  }
  session.sync.camera_offset.contradicts = false;
  session.sync.camera_offset.row_delay_s.reset();
  for (auto& speed : session.sync.servo.speeds) {
    speed.reached_dps = std::numeric_limits<double>::quiet_NaN();
    speed.contradicts = false;
    speed.noise_dps = 0.0;
  }
  session.sync.servo.ripples.clear();
  return session;
}

/// What a file of format 2.0 can hold of a session: the profile and all names are those of today.
inline Session format_2_0_session(Session session) {
  const RigProfile profile = session.raw.header.profile;
  session = format_1_session(std::move(session));
  session.raw.header.profile = profile;
  return session;
}

inline void write_format_2_0(const std::filesystem::path& path, const Session& session) {
  write_unchecked(path, session);
  const EditedFile file(path);
  remove_later_labels(file.id());
  const std::string header =
      get_text_attribute(Handle(H5Gopen2(file.id(), "/rig", H5P_DEFAULT), "open it").get(), "header_json");
  file.replace("/", "format_version", "2.0.0");
  file.replace("/", "scalars_crc32", scalars_crc32(session, header, {2, 0}));
  file.renew_sums();
}

inline void write_format_1(const std::filesystem::path& path, const Session& session) {
  write_unchecked(path, session);
  const Format1File file(path, session);
}

}  // namespace thermorig::session
