// SPDX-License-Identifier: MIT
#include "thermorig/rig/profile_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <span>
#include <string_view>
#include <system_error>
#include <vector>

#include "servo_link.h"
#include "thermorig/core/error.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "toml_table.h"
#include "toml_text.h"

namespace thermorig::rig {

namespace {

/// "2026-07-25", or the same with a time of day behind it: ISO 8601 in UTC.
bool is_date(const std::string& text) {
  constexpr std::string_view day = "dddd-dd-dd";
  constexpr std::string_view allowed_after = "0123456789T:.Z";
  if (text.size() < day.size() || text.size() > 32) return false;
  for (std::size_t i = 0; i < day.size(); ++i)
    if (day[i] == 'd' ? text[i] < '0' || text[i] > '9' : text[i] != day[i]) return false;
  return text.find_first_not_of(allowed_after, day.size()) == std::string::npos;
}

/// Takes values out of a table; what is not there stays as it is.
class ProfileReader {
 public:
  explicit ProfileReader(TomlTable& table) : table_(table) {}

  void number(const char* key, double& value, double min, double max, const char*) {
    value = table_.number(key, min, max).value_or(value);
  }
  template <typename Integer>
  void integer(const char* key, Integer& value, std::int64_t min, std::int64_t max, const char*) {
    if (const auto found = table_.integer(key, min, max)) value = static_cast<Integer>(*found);
  }
  void boolean(const char* key, bool& value, const char*) { value = table_.boolean(key).value_or(value); }
  void text(const char* key, std::string& value, const char*) { value = table_.text(key).value_or(value); }
  void date(const char* key, std::string& value, const char* comment) {
    text(key, value, comment);
    if (!value.empty() && !is_date(value))
      table_.refuse(key, fmt::format("{} = \"{}\" is not a date", key, value),
                    "UTC as in \"2026-07-25T14:35:12Z\", or \"\" for an assumption");
  }
  template <typename Choice>
  void choice(const char* key, Choice& value, const std::vector<std::string>& words, const char*) {
    if (const auto found = table_.choice(key, words)) value = static_cast<Choice>(*found);
  }
  void name(const char* key, std::string& value, const std::vector<std::string>& names, const char*) {
    if (const auto found = table_.choice(key, names)) value = names[*found];
  }

 private:
  TomlTable& table_;
};

/// Writes the same keys as lines with a comment.
class ProfileWriter {
 public:
  void heading(const std::string& name) { text_ += fmt::format("\n[{}]\n", name); }
  void number(const char* key, double value, double, double, const char* comment) {
    line(key, fmt::format("{}", value), comment);
  }
  template <typename Integer>
  void integer(const char* key, Integer value, std::int64_t, std::int64_t, const char* comment) {
    line(key, fmt::format("{}", value), comment);
  }
  void boolean(const char* key, bool value, const char* comment) {
    line(key, value ? "true" : "false", comment);
  }
  void text(const char* key, const std::string& value, const char* comment) {
    line(key, toml_quoted(value), comment);
  }
  void date(const char* key, const std::string& value, const char* comment) { text(key, value, comment); }
  template <typename Choice>
  void choice(const char* key, Choice value, const std::vector<std::string>& words, const char* comment) {
    line(key, toml_quoted(words.at(static_cast<std::size_t>(value))), comment);
  }
  void name(const char* key, const std::string& value, const std::vector<std::string>&, const char* comment) {
    text(key, value, comment);
  }
  std::string take() { return std::move(text_); }

 private:
  void line(const char* key, const std::string& value, const char* comment) {
    text_ += fmt::format("{:<32}  # {}\n", fmt::format("{} = {}", key, value), comment);
  }
  std::string text_ = "# A rig of thermorig: what is connected, and how. Keys may be left out.\n";
};

// One list of keys for reading and writing. Ranges are those in which the value means something at all;
// whether a plan can be driven is checked against the plan.

/// "a, b or c".
std::string any_of(const std::vector<std::string>& names) {
  if (names.size() == 1) return names.front();
  const auto all_but_last = std::span(names).first(names.size() - 1);
  return fmt::format("{} or {}", fmt::join(all_but_last, ", "), names.back());
}

constexpr const char* measured = "when that was calibrated, UTC; empty: an assumption";

template <typename Visitor>
void visit_link(Visitor& visitor, PortProfile& link) {
  visitor.text("port", link.port, "e.g. /dev/serial/by-id/...; empty: not chosen yet");
  visitor.text("usb_path", link.usb_path, "USB topology, e.g. 1-4.2; may be empty");
  visitor.integer("baud", link.baud, 0, 12'000'000, "bits per second, 8N1; 0: does not apply (USB-CDC)");
  visitor.number("latency_s", link.latency_s, -0.1, 1.0, "constant delay from the sample to its first byte");
  visitor.number("latency_uncertainty_s", link.latency_uncertainty_s, 0.0, 1.0,
                 "one standard deviation of it");
  visitor.date("latency_measured_utc", link.latency_measured_utc, measured);
  visitor.number("largest_constant_delay_s", link.largest_constant_delay_s, 0.0, 1.0,
                 "even the fastest byte is read at most so late; one-way lower bounds rest on it");
  visitor.number("wander_ppm", link.wander_ppm, 0.1, 50'000.0,
                 "the device's clock stays so close to its mean rate");
  visitor.boolean("reset_on_open", link.reset_on_open, "toggle DTR after opening");
}

template <typename Visitor>
void visit_camera(Visitor& visitor, CameraProfile& camera) {
  visit_link(visitor, camera.link);
  visitor.text("model", camera.model, "free text");
  const std::vector<std::string> protocols = sensors::camera_protocol_names();
  visitor.name("protocol", camera.protocol, protocols, any_of(protocols).c_str());
  visitor.number("output_rate_hz", camera.output_rate_hz, 0.1, 64.0, "frames a second, nominal");
  visitor.number("field_of_view_deg", camera.field_of_view_deg, 1.0, 180.0,
                 "horizontal: 55 (BAB) or 110 (BAA)");
  visitor.boolean("mirrored", camera.mirrored, "the order on the wire is a mirror image of the scene");
  visitor.date("orientation_measured_utc", camera.orientation_measured_utc,
               "when `mirrored` and the gyro's axis and sign were calibrated, UTC; empty: assumptions");
  visitor.choice("checksum", camera.checksum, {"word", "byte", "ignore"}, "word, byte or ignore");
}

template <typename Visitor>
void visit_gyro(Visitor& visitor, GyroProfile& gyro) {
  visit_link(visitor, gyro.link);
  visitor.text("model", gyro.model, "free text");
  const std::vector<std::string> protocols = sensors::gyro_protocol_names();
  visitor.name("protocol", gyro.protocol, protocols, any_of(protocols).c_str());
  visitor.number("output_rate_hz", gyro.output_rate_hz, 1.0, 8000.0, "samples a second, nominal");
  visitor.choice("axis", gyro.axis, {"x", "y", "z"}, "the servo's axis: x, y or z");
  visitor.integer("sign", gyro.sign, -1, 1, "1 or -1: a positive command then gives a positive rate");
  visitor.number("scale", gyro.scale, 0.5, 2.0, "measured rate = scale * true rate + bias, sign applied");
  visitor.number("scale_uncertainty", gyro.scale_uncertainty, 0.0, 1.0, "one standard deviation of it");
  visitor.date("scale_measured_utc", gyro.scale_measured_utc, measured);
  visitor.number("bias_dps", gyro.bias_dps, -200.0, 200.0, "measured rate at rest, sign applied");
  visitor.number("bias_uncertainty_dps", gyro.bias_uncertainty_dps, 0.0, 200.0,
                 "one standard deviation of it");
  visitor.date("bias_measured_utc", gyro.bias_measured_utc, measured);
}

template <typename Visitor>
void visit_text_columns(Visitor& visitor, TextColumns& text) {
  visitor.text("prefix", text.prefix, "lines must start with it; empty: any line");
  visitor.integer("x_column", text.rate[0], -1, 63, "columns from 0; -1: not sent");
  visitor.integer("y_column", text.rate[1], -1, 63, "");
  visitor.integer("z_column", text.rate[2], -1, 63, "");
  visitor.number("scale_dps", text.scale_dps, 1e-9, 1e6, "degrees per second of one unit");
  visitor.integer("time_column", text.time, -1, 63, "column of the device's time; -1: none");
  visitor.number("time_unit_s", text.time_unit_s, 1e-9, 1.0, "seconds of one unit of it");
}

bool has_settings(const GyroProfile& gyro) {
  return !sensors::gyro_protocol(gyro.protocol).settings.empty();
}

/// What the gyro's protocol wants to know beside the columns.
template <typename Visitor>
void visit_settings(Visitor& visitor, GyroProfile& gyro) {
  for (const sensors::GyroSetting& setting : sensors::gyro_protocol(gyro.protocol).settings) {
    double value = gyro.setting(setting.name);
    if (setting.is_whole)
      visitor.integer(setting.name, value, std::llround(setting.min), std::llround(setting.max),
                      setting.comment);
    else
      visitor.number(setting.name, value, setting.min, setting.max, setting.comment);
    if (value != 0.0) gyro.settings[setting.name] = value;
  }
}

template <typename Visitor>
void visit_servo(Visitor& visitor, ServoProfile& servo) {
  constexpr double pulse_min_us = SERVO_LIMIT_PULSE_MIN_US;
  constexpr double pulse_max_us = SERVO_LIMIT_PULSE_MAX_US;
  constexpr double rate_max_dps = SERVO_LIMIT_RATE_CDPS / 100.0;
  constexpr double span_max = SERVO_LIMIT_SPAN / 100.0;
  visit_link(visitor, servo.link);
  visitor.text("model", servo.model, "free text");
  visitor.choice("kind", servo.kind, {"positional", "continuous"}, "positional or continuous");
  visitor.number(
      "travel_deg", servo.travel_deg, 0.0, span_max,
      "positional: angle from shortest to longest pulse; continuous: what its cable bears, 0: any");
  visitor.number("full_rate_dps", servo.full_rate_dps, 0.0, span_max / 2.0,
                 "continuous: speed at the longest pulse");
  visitor.number("pulse_min_us", servo.pulse_min_us, pulse_min_us, pulse_max_us, "shortest pulse");
  visitor.number("pulse_max_us", servo.pulse_max_us, pulse_min_us, pulse_max_us, "longest pulse");
  visitor.number("max_rate_dps", servo.max_rate_dps, 0.1, rate_max_dps, "never commanded beyond");
  visitor.number("acceleration_dps2", servo.acceleration_dps2, SERVO_LIMIT_ACCELERATION_MIN_DPS2,
                 SERVO_LIMIT_ACCELERATION_DPS2, "of every ramp");
  visitor.number("stop_margin_deg", servo.stop_margin_deg, 0.0, 1000.0, "kept from either end of the travel");
  visitor.number("settle_s", servo.settle_s, 0.0, 10.0, "after a change of speed, until the shaft follows");
  visitor.number("loop_hz", servo.loop_hz, 0.5, 100.0,
                 "bandwidth of the servo's own loop, until a recording tells better");
  visitor.number("scale", servo.scale, 0.5, 2.0, "shaft angle per commanded angle");
  visitor.number("scale_uncertainty", servo.scale_uncertainty, 0.0, 1.0, "one standard deviation of it");
  visitor.date("scale_measured_utc", servo.scale_measured_utc, measured);
}

void check_consistency(const RigProfile& profile, const TomlTable& gyro, const TomlTable& servo) {
  if (profile.gyro.sign == 0) gyro.refuse("sign", "sign = 0 is out of range", "1 or -1");
  const ServoProfile& s = profile.servo;
  if (s.pulse_min_us >= s.pulse_max_us)
    servo.refuse("pulse_min_us", "pulse_min_us is not below pulse_max_us", "e.g. 500 and 2500");
  if (s.kind == ServoKind::continuous && s.full_rate_dps <= 0.0)
    servo.refuse("kind", "a continuous servo needs full_rate_dps",
                 "its speed at the longest pulse, e.g. 250");
  const bool has_limits = s.kind == ServoKind::positional || s.travel_deg > 0.0;
  if (has_limits && s.travel_deg - 2.0 * s.stop_margin_deg < 1.0)
    servo.refuse("stop_margin_deg", "the margins leave no travel",
                 "stop_margin_deg below half of travel_deg");
}

[[noreturn]] void refuse_writing(const std::filesystem::path& path, const std::string& why) {
  throw Error(ExitCode::storage, "the rig profile cannot be written: " + why, path.string(),
              "choose a folder that you may write to");
}

}  // namespace

RigProfile parse_profile(const std::string& text, const std::string& file_name) {
  RigProfile profile;
  TomlTable root = TomlTable::parse(text, file_name);
  profile.name = root.text("name").value_or(profile.name);
  TomlTable camera = root.table("camera");
  TomlTable gyro = root.table("gyro");
  TomlTable servo = root.table("servo");
  TomlTable columns = gyro.table("text");
  ProfileReader camera_reader(camera), gyro_reader(gyro), servo_reader(servo), columns_reader(columns);
  visit_camera(camera_reader, profile.camera);
  visit_gyro(gyro_reader, profile.gyro);
  visit_text_columns(columns_reader, profile.gyro.text);
  if (has_settings(profile.gyro)) {
    TomlTable settings = gyro.table(profile.gyro.protocol);
    ProfileReader settings_reader(settings);
    visit_settings(settings_reader, profile.gyro);
    settings.refuse_unknown();
  }
  visit_servo(servo_reader, profile.servo);
  for (const TomlTable* table : {&root, &camera, &gyro, &columns, &servo}) table->refuse_unknown();
  check_consistency(profile, gyro, servo);
  return profile;
}

RigProfile read_profile(const std::filesystem::path& path) {
  return parse_profile(read_text_file(path.string(), "rig profile"), path.string());
}

std::string profile_text(const RigProfile& profile) {
  RigProfile copy = profile;  // the visits take references because the reader fills them in
  ProfileWriter writer;
  writer.text("name", copy.name, "how this rig is called");
  writer.heading("camera");
  visit_camera(writer, copy.camera);
  writer.heading("gyro");
  visit_gyro(writer, copy.gyro);
  writer.heading("gyro.text");
  visit_text_columns(writer, copy.gyro.text);
  if (has_settings(copy.gyro)) {
    writer.heading("gyro." + copy.gyro.protocol);
    visit_settings(writer, copy.gyro);
  }
  writer.heading("servo");
  visit_servo(writer, copy.servo);
  return writer.take();
}

void require_profile_storage(const std::filesystem::path& path) {
  std::error_code hidden;
  if (std::filesystem::exists(path, hidden)) read_profile(path);
  std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  while (!std::filesystem::exists(folder, hidden) && folder.has_relative_path())
    folder = folder.parent_path();
  if (!std::filesystem::is_directory(folder, hidden))
    refuse_writing(path, folder.string() + " is not a folder");
  if (::access(folder.c_str(), W_OK | X_OK) != 0)
    refuse_writing(path, folder.string() + ": " + std::generic_category().message(errno));
}

void write_profile(const std::filesystem::path& path, const RigProfile& profile) {
  const std::filesystem::path temporary = path.string() + ".new";
  std::error_code failure;
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), failure);
  if (failure) refuse_writing(path, "its folder cannot be made: " + failure.message());
  std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
  file << profile_text(profile);
  file.close();
  if (!file) refuse_writing(path, "writing failed");
  std::filesystem::rename(temporary, path, failure);
  if (failure) refuse_writing(path, failure.message());
}

}  // namespace thermorig::rig
