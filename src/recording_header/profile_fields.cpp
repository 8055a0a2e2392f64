// SPDX-License-Identifier: MIT
#include "thermorig/recording_header/profile_fields.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <type_traits>
#include <utility>

#include "servo_link.h"
#include "thermorig/sensors/gyro_protocol.h"

namespace thermorig::recording_header {

namespace {

/// Grows by a line for each field. `member` refers to the field in a profile, constant or not.
class FieldList {
 public:
  void begin_table(std::string name) { table_ = std::move(name); }

  template <typename Member>
  void number(const char* name, const char* unit, double min, double max, const char* help, Member member) {
    using Number = std::remove_reference_t<decltype(member(std::declval<RigProfile&>()))>;
    using Outside = std::conditional_t<std::is_integral_v<Number>, std::int64_t, double>;
    add<Outside>({.name = name, .unit = unit, .help = help, .min = min, .max = max}, member);
  }
  template <typename Member>
  void boolean(const char* name, const char* help, Member member) {
    add<bool>({.name = name, .help = help}, member);
  }
  template <typename Member>
  void text(const char* name, const char* help, Member member) {
    add<std::string>({.name = name, .help = help}, member);
  }
  template <typename Member>
  void date(const char* name, const char* help, Member member) {
    add<std::string>({.name = name, .help = help, .is_date = true}, member);
  }
  template <typename Member>
  void one_of(const std::vector<std::string>& words, const char* name, const std::string& help,
              Member member) {
    add<std::string>({.name = name, .help = help, .words = words}, member);
  }
  /// The member is the index of its word.
  template <typename Member>
  void choice(const std::vector<std::string>& words, const char* name, const char* help, Member member) {
    ProfileField field{.name = name, .help = help, .words = words};
    field.get = [member, words](const RigProfile& profile) -> FieldValue {
      const auto index = static_cast<std::size_t>(member(profile));
      return index < words.size() ? words[index] : std::to_string(index);
    };
    field.set = [member, words](RigProfile& profile, const FieldValue& value) {
      auto& place = member(profile);
      const auto word = std::find(words.begin(), words.end(), std::get<std::string>(value));
      place = static_cast<std::remove_reference_t<decltype(place)>>(word - words.begin());
    };
    keep(std::move(field));
  }

  std::vector<ProfileField> take() { return std::move(fields_); }

 private:
  template <typename Outside, typename Member>
  void add(ProfileField field, Member member) {
    field.get = [member](const RigProfile& profile) -> FieldValue {
      return static_cast<Outside>(member(profile));
    };
    field.set = [member](RigProfile& profile, const FieldValue& value) {
      auto& place = member(profile);
      place = static_cast<std::remove_reference_t<decltype(place)>>(std::get<Outside>(value));
    };
    keep(std::move(field));
  }

  void keep(ProfileField field) {
    field.table = table_;
    field.standard = field.get(RigProfile());
    fields_.push_back(std::move(field));
  }

  std::string table_;
  std::vector<ProfileField> fields_;
};

constexpr double largest_whole = 1e15;  // of a double that counts: far below where it skips numbers
constexpr const char* measured = "when that was calibrated, UTC; empty: an assumption";
constexpr const char* one_deviation = "one standard deviation of it";

void add_link(FieldList& list, Device device) {
  list.text(
      "port", "e.g. /dev/serial/by-id/...; empty: not chosen yet", [=](auto& profile) -> auto& {
        return profile.link(device).port;
      });
  list.text(
      "usb_path", "USB topology, e.g. 1-4.2; may be empty", [=](auto& profile) -> auto& {
        return profile.link(device).usb_path;
      });
  list.number(
      "baud", "bit/s", 0, 12'000'000,
      "bits per second, 8N1; 0: does not apply (USB-CDC)", [=](auto& profile) -> auto& {
        return profile.link(device).baud;
      });
  list.number(
      "latency_s", "s", -0.1, 1,
      "constant delay from the sample to its first byte", [=](auto& profile) -> auto& {
        return profile.link(device).latency_s;
      });
  list.number(
      "latency_uncertainty_s", "s", 0, 1,
      one_deviation, [=](auto& profile) -> auto& { return profile.link(device).latency_uncertainty_s; });
  list.date(
      "latency_measured_utc",
      measured, [=](auto& profile) -> auto& { return profile.link(device).latency_measured_utc; });
  list.number(
      "largest_constant_delay_s", "s", 0, 1,
      "even the fastest byte is read at most so late; one-way lower bounds rest on it",
      [=](auto& profile) -> auto& { return profile.link(device).largest_constant_delay_s; });
  list.number(
      "wander_ppm", "1e-6", 0.1, 50'000,
      "the device's clock stays so close to its mean rate", [=](auto& profile) -> auto& {
        return profile.link(device).wander_ppm;
      });
  list.boolean(
      "reset_on_open",
      "toggle DTR after opening", [=](auto& profile) -> auto& { return profile.link(device).reset_on_open; });
}

void add_camera(FieldList& list) {
  list.begin_table("camera");
  add_link(list, Device::camera);
  list.text(
      "model", "free text", [](auto& profile) -> auto& { return profile.camera.model; });
  list.number(
      "output_rate_hz", "Hz", 0.1, 64, "frames a second, nominal",
      [](auto& profile) -> auto& { return profile.camera.output_rate_hz; });
  list.number(
      "field_of_view_deg", "deg", 1, 180, "horizontal: 55 (BAB) or 110 (BAA)",
      [](auto& profile) -> auto& { return profile.camera.field_of_view_deg; });
  list.boolean(
      "mirrored", "the order on the wire is a mirror image of the scene",
      [](auto& profile) -> auto& { return profile.camera.mirrored; });
  list.date(
      "orientation_measured_utc",
      "when `mirrored` and the gyro's axis and sign were calibrated, UTC; empty: assumptions",
      [](auto& profile) -> auto& { return profile.camera.orientation_measured_utc; });
  list.choice(
      {"word", "byte", "ignore"}, "checksum", "word, byte or ignore",
      [](auto& profile) -> auto& { return profile.camera.checksum; });
}

/// "a, b or c".
std::string any_of(const std::vector<std::string>& names) {
  const auto all_but_last = std::span(names).first(names.size() - 1);
  return fmt::format("{} or {}", fmt::join(all_but_last, ", "), names.back());
}

void add_gyro(FieldList& list) {
  list.begin_table("gyro");
  add_link(list, Device::gyro);
  list.text(
      "model", "free text", [](auto& profile) -> auto& { return profile.gyro.model; });
  const std::vector<std::string> protocols = sensors::gyro_protocol_names();
  list.one_of(
      protocols, "protocol", any_of(protocols), [](auto& profile) -> auto& { return profile.gyro.protocol; });
  list.number(
      "output_rate_hz", "Hz", 1, 8000, "samples a second, nominal",
      [](auto& profile) -> auto& { return profile.gyro.output_rate_hz; });
  list.choice(
      {"x", "y", "z"}, "axis", "the servo's axis: x, y or z",
      [](auto& profile) -> auto& { return profile.gyro.axis; });
  list.number(
      "sign", "1", -1, 1, "1 or -1: a positive command then gives a positive rate",
      [](auto& profile) -> auto& { return profile.gyro.sign; });
  list.number(
      "scale", "1", 0.5, 2, "measured rate = scale * true rate + bias, sign applied",
      [](auto& profile) -> auto& { return profile.gyro.scale; });
  list.number(
      "scale_uncertainty", "1", 0, 1, one_deviation,
      [](auto& profile) -> auto& { return profile.gyro.scale_uncertainty; });
  list.date(
      "scale_measured_utc", measured, [](auto& profile) -> auto& { return profile.gyro.scale_measured_utc; });
  list.number(
      "bias_dps", "deg/s", -200, 200, "measured rate at rest, sign applied",
      [](auto& profile) -> auto& { return profile.gyro.bias_dps; });
  list.number(
      "bias_uncertainty_dps", "deg/s", 0, 200, one_deviation,
      [](auto& profile) -> auto& { return profile.gyro.bias_uncertainty_dps; });
  list.date(
      "bias_measured_utc", measured, [](auto& profile) -> auto& { return profile.gyro.bias_measured_utc; });
}

void add_text_columns(FieldList& list) {
  constexpr int last_column = 63;
  list.begin_table("gyro.text");
  list.text(
      "prefix", "lines must start with it; empty: any line",
      [](auto& profile) -> auto& { return profile.gyro.text.prefix; });
  list.number(
      "x_column", "1", -1, last_column, "columns from 0; -1: not sent",
      [](auto& profile) -> auto& { return profile.gyro.text.rate[0]; });
  list.number(
      "y_column", "1", -1, last_column, "likewise",
      [](auto& profile) -> auto& { return profile.gyro.text.rate[1]; });
  list.number(
      "z_column", "1", -1, last_column, "likewise",
      [](auto& profile) -> auto& { return profile.gyro.text.rate[2]; });
  list.number(
      "scale_dps", "deg/s", 1e-9, 1e6, "degrees per second of one unit",
      [](auto& profile) -> auto& { return profile.gyro.text.scale_dps; });
  list.number(
      "time_column", "1", -1, last_column, "column of the device's time; -1: none",
      [](auto& profile) -> auto& { return profile.gyro.text.time; });
  list.number(
      "time_unit_s", "s", 1e-9, 1, "seconds of one unit of it",
      [](auto& profile) -> auto& { return profile.gyro.text.time_unit_s; });
}

void add_servo(FieldList& list) {
  constexpr double pulse_min_us = SERVO_LIMIT_PULSE_MIN_US;
  constexpr double pulse_max_us = SERVO_LIMIT_PULSE_MAX_US;
  constexpr double span_max = SERVO_LIMIT_SPAN / 100.0;
  list.begin_table("servo");
  add_link(list, Device::servo);
  list.text(
      "model", "free text", [](auto& profile) -> auto& { return profile.servo.model; });
  list.choice(
      {"positional", "continuous"}, "kind", "positional or continuous",
      [](auto& profile) -> auto& { return profile.servo.kind; });
  list.number(
      "travel_deg", "deg", 0, span_max,
      "positional: angle from shortest to longest pulse; continuous: what its cable bears, 0: any",
      [](auto& profile) -> auto& { return profile.servo.travel_deg; });
  list.number(
      "full_rate_dps", "deg/s", 0, span_max / 2, "continuous: speed at the longest pulse",
      [](auto& profile) -> auto& { return profile.servo.full_rate_dps; });
  list.number(
      "pulse_min_us", "us", pulse_min_us, pulse_max_us, "shortest pulse",
      [](auto& profile) -> auto& { return profile.servo.pulse_min_us; });
  list.number(
      "pulse_max_us", "us", pulse_min_us, pulse_max_us, "longest pulse",
      [](auto& profile) -> auto& { return profile.servo.pulse_max_us; });
  list.number(
      "max_rate_dps", "deg/s", 0.1, SERVO_LIMIT_RATE_CDPS / 100.0, "never commanded beyond",
      [](auto& profile) -> auto& { return profile.servo.max_rate_dps; });
  list.number(
      "acceleration_dps2", "deg/s^2", SERVO_LIMIT_ACCELERATION_MIN_DPS2, SERVO_LIMIT_ACCELERATION_DPS2,
      "of every ramp", [](auto& profile) -> auto& { return profile.servo.acceleration_dps2; });
  list.number(
      "stop_margin_deg", "deg", 0, 1000, "kept from either end of the travel",
      [](auto& profile) -> auto& { return profile.servo.stop_margin_deg; });
  list.number(
      "settle_s", "s", 0, 10, "after a change of speed, until the shaft follows",
      [](auto& profile) -> auto& { return profile.servo.settle_s; });
  list.number(
      "loop_hz", "Hz", 0.5, 100, "bandwidth of the servo's own loop, until a recording tells better",
      [](auto& profile) -> auto& { return profile.servo.loop_hz; });
  list.number(
      "scale", "1", 0.5, 2, "shaft angle per commanded angle",
      [](auto& profile) -> auto& { return profile.servo.scale; });
  list.number(
      "scale_uncertainty", "1", 0, 1, one_deviation,
      [](auto& profile) -> auto& { return profile.servo.scale_uncertainty; });
  list.date(
      "scale_measured_utc", measured,
      [](auto& profile) -> auto& { return profile.servo.scale_measured_utc; });
}

ProfileField setting_field(const std::string& table, const sensors::GyroSetting& setting) {
  ProfileField field{.table = table,
                     .name = setting.name,
                     .help = setting.comment,
                     .min = setting.min,
                     .max = setting.max};
  // A value that is not whole stays what it is, so that the check finds it.
  field.get = [name = field.name, is_whole = setting.is_whole](const RigProfile& profile) -> FieldValue {
    const double value = profile.gyro.setting(name);
    if (is_whole && std::abs(value) <= largest_whole && std::trunc(value) == value)
      return static_cast<std::int64_t>(value);
    return value;
  };
  field.set = [name = field.name](RigProfile& profile, const FieldValue& value) {
    const auto* const whole = std::get_if<std::int64_t>(&value);
    const double number = whole != nullptr ? static_cast<double>(*whole) : std::get<double>(value);
    if (number != 0.0) profile.gyro.settings[name] = number;
  };
  field.standard = field.get(RigProfile());
  return field;
}

}  // namespace

const std::vector<ProfileField>& profile_fields() {
  static const std::vector<ProfileField> fields = [] {
    FieldList list;
    list.text(
        "name", "how this rig is called", [](auto& profile) -> auto& { return profile.name; });
    add_camera(list);
    add_gyro(list);
    add_text_columns(list);
    add_servo(list);
    return list.take();
  }();
  return fields;
}

std::vector<ProfileField> setting_fields(const std::string& protocol) {
  std::vector<ProfileField> fields;
  if (const sensors::GyroProtocol* const known = sensors::find_gyro_protocol(protocol))
    for (const sensors::GyroSetting& setting : known->settings)
      fields.push_back(setting_field("gyro." + protocol, setting));
  return fields;
}

void for_each_field(const RigProfile& profile,
                    const std::function<void(const ProfileField& field, const FieldValue& value)>& use) {
  for (const ProfileField& field : profile_fields()) use(field, field.get(profile));
  for (const ProfileField& field : setting_fields(profile.gyro.protocol)) use(field, field.get(profile));
}

}  // namespace thermorig::recording_header
