// SPDX-License-Identifier: MIT
#include "thermorig/storage/recording_header/profile_fields.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <type_traits>
#include <utility>

#include "servo_link.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/gyro_sketch.h"
#include "thermorig/sensors/servo_protocol.h"

namespace thermorig::recording_header {

namespace {

using Fields = std::vector<ProfileField>;
using Words = std::vector<std::string>;

/// Adds the fields of one table that are members of one part of the profile.
template <typename Part>
class Table {
 public:
  using Find = std::function<const Part&(const RigProfile&)>;

  Table(Fields& fields, std::string name, Find part)
      : fields_(fields), name_(std::move(name)), part_(std::move(part)) {}

  template <typename Member>
  void number(const char* name, Member member, const char* unit, double min, double max, const char* help) {
    using Number = std::decay_t<std::invoke_result_t<Member, Part&>>;
    using Outside = std::conditional_t<std::is_integral_v<Number>, std::int64_t, double>;
    add<Outside>({.name = name, .unit = unit, .help = help, .min = min, .max = max}, member);
  }
  void boolean(const char* name, bool Part::*member, const char* help) {
    add<bool>({.name = name, .help = help}, member);
  }
  void text(const char* name, std::string Part::*member, const std::string& help, const Words& words = {}) {
    add<std::string>({.name = name, .help = help, .words = words}, member);
  }
  void date(const char* name, std::string Part::*member, const char* help) {
    add<std::string>({.name = name, .help = help, .is_date = true}, member);
  }
  /// The member is the index of its word.
  template <typename Choice>
  void choice(const char* name, Choice Part::*member, const Words& words, const char* help) {
    ProfileField field{.name = name, .help = help, .words = words};
    field.get = [part = part_, member, words](const RigProfile& profile) -> FieldValue {
      const auto index = static_cast<std::size_t>(part(profile).*member);
      return index < words.size() ? words[index] : std::to_string(index);
    };
    field.set = [part = part_, member, words](RigProfile& profile, const FieldValue& value) {
      const auto word = std::find(words.begin(), words.end(), std::get<std::string>(value));
      writable(part(profile)).*member = static_cast<Choice>(word - words.begin());
    };
    keep(std::move(field));
  }

 private:
  template <typename Outside, typename Member>
  void add(ProfileField field, Member member) {
    field.get = [part = part_, member](const RigProfile& profile) -> FieldValue {
      return static_cast<Outside>(std::invoke(member, part(profile)));
    };
    field.set = [part = part_, member](RigProfile& profile, const FieldValue& value) {
      auto& place = std::invoke(member, writable(part(profile)));
      place = static_cast<std::remove_reference_t<decltype(place)>>(std::get<Outside>(value));
    };
    keep(std::move(field));
  }

  /// `set` has it of a profile that is not constant.
  static Part& writable(const Part& part) { return const_cast<Part&>(part); }

  void keep(ProfileField field) {
    field.table = name_;
    field.standard = field.get(RigProfile());
    fields_.push_back(std::move(field));
  }

  Fields& fields_;
  std::string name_;
  Find part_;
};

constexpr double largest_whole = 1e15;  // of a double that counts: far below where it skips numbers
constexpr const char* measured = "when that was calibrated, UTC; empty: an assumption";
constexpr const char* deviation = "one standard deviation of it";

void add_link(Fields& fields, const std::string& name, Device device) {
  using Link = PortProfile;
  Table<Link> table(fields, name, [=](const RigProfile& rig) -> const Link& { return rig.link(device); });
  table.text("port", &Link::port, "e.g. /dev/serial/by-id/...; empty: not chosen yet");
  table.text("usb_path", &Link::usb_path, "USB topology, e.g. 1-4.2; may be empty");
  table.number("baud", &Link::baud, "bit/s", 0, 12e6, "bits per second, 8N1; 0: does not apply (USB-CDC)");
  table.number("latency_s", &Link::latency_s, "s", -0.1, 1,
               "constant delay from the sample to its first byte");
  table.number("latency_uncertainty_s", &Link::latency_uncertainty_s, "s", 0, 1, deviation);
  table.date("latency_measured_utc", &Link::latency_measured_utc, measured);
  table.number("largest_constant_delay_s", &Link::largest_constant_delay_s, "s", 0, 1,
               "even the fastest byte is read at most so late; one-way lower bounds rest on it");
  table.number("wander_ppm", &Link::wander_ppm, "1e-6", 0.1, 50'000,
               "the device's clock stays so close to its mean rate");
  table.boolean("reset_on_open", &Link::reset_on_open, "toggle DTR after opening");
}

/// "a, b or c".
std::string any_of(const Words& names) {
  if (names.size() == 1) return names.front();
  const auto all_but_last = std::span(names).first(names.size() - 1);
  return fmt::format("{} or {}", fmt::join(all_but_last, ", "), names.back());
}

void add_camera(Fields& fields) {
  using Camera = CameraProfile;
  const Words protocols = sensors::camera_protocol_names();
  add_link(fields, "camera", Device::camera);
  Table<Camera> table(fields, "camera", &RigProfile::camera);
  table.text("model", &Camera::model, "free text");
  table.text("protocol", &Camera::protocol, any_of(protocols), protocols);
  table.number("output_rate_hz", &Camera::output_rate_hz, "Hz", 0.1, 64, "frames a second, nominal");
  table.number("field_of_view_deg", &Camera::field_of_view_deg, "deg", 1, 180,
               "horizontal: 55 (BAB) or 110 (BAA)");
  table.boolean("mirrored", &Camera::mirrored, "the order on the wire is a mirror image of the scene");
  table.date("orientation_measured_utc", &Camera::orientation_measured_utc,
             "when `mirrored` and the gyro's axis and sign were calibrated, UTC; empty: assumptions");
  table.choice("checksum", &Camera::checksum, {"word", "byte", "ignore"}, "word, byte or ignore");
  table.number("pitch_scale", &Camera::pitch_scale, "1", 0.9, 1.1,
               "distance between columns, against field_of_view_deg / 32");
  table.number("pitch_scale_uncertainty", &Camera::pitch_scale_uncertainty, "1", 0, 1,
               "one standard deviation");
  table.number("distortion", &Camera::distortion, "1", -0.2, 0.2,
               "corners look further out by this share, growing with the square");
  table.number("distortion_uncertainty", &Camera::distortion_uncertainty, "1", 0, 1,
               "one standard deviation");
  table.number("tilt_deg", &Camera::tilt_deg, "deg", -15, 15, "the camera looks upward by so much");
  table.number("roll_deg", &Camera::roll_deg, "deg", -15, 15,
               "about the optical axis: the side of growing angles is higher");
  table.number("row_spread", &Camera::row_spread, "1", -1, 1,
               "share of a refresh period over which rows are exposed one after the other; below 0: from the "
               "last on");
  table.date("lens_measured_utc", &Camera::lens_measured_utc,
             "when the lens (from `pitch_scale` on) was calibrated, UTC; empty: assumptions");
}

/// Stands in front of what it says of a gyro: keys behind it may say otherwise.
void add_sketch(Fields& fields) {
  Words names{""};
  for (const sensors::GyroSketch& sketch : sensors::gyro_sketches())
    if (!sketch.name.empty()) names.emplace_back(sketch.name);
  Table<GyroProfile>(fields, "gyro", &RigProfile::gyro)
      .text("sketch", &GyroProfile::sketch,
            "of text gyros: whose lines (protocols/text_gyro.md), with all that "
            "this says of the keys below; empty: none",
            names);
  fields.back().set = [](RigProfile& profile, const FieldValue& value) {
    const std::string& name = std::get<std::string>(value);
    if (!name.empty()) sensors::choose_gyro(name, profile.gyro);
  };
}

void add_gyro(Fields& fields) {
  using Gyro = GyroProfile;
  const Words protocols = sensors::gyro_protocol_names();
  add_sketch(fields);
  add_link(fields, "gyro", Device::gyro);
  Table<Gyro> table(fields, "gyro", &RigProfile::gyro);
  table.text("model", &Gyro::model, "free text");
  table.text("protocol", &Gyro::protocol, any_of(protocols), protocols);
  table.number("output_rate_hz", &Gyro::output_rate_hz, "Hz", 1, 8000, "samples a second, nominal");
  table.number("bandwidth_hz", &Gyro::bandwidth_hz, "Hz", 0, 8000,
               "of the gyro's low-pass, 3 dB down; 0: not known");
  table.number("filter_delay_s", &Gyro::filter_delay_s, "s", 0, 0.2,
               "its group delay, which is in no other latency; 0: 0.225 / bandwidth_hz");
  table.choice("axis", &Gyro::axis, {"x", "y", "z"}, "the servo's axis: x, y or z");
  table.number("sign", &Gyro::sign, "1", -1, 1, "1 or -1: a positive command then gives a positive rate");
  table.number("scale", &Gyro::scale, "1", 0.5, 2, "measured rate = scale * true rate + bias, sign applied");
  table.number("scale_uncertainty", &Gyro::scale_uncertainty, "1", 0, 1, deviation);
  table.date("scale_measured_utc", &Gyro::scale_measured_utc, measured);
  table.number("bias_dps", &Gyro::bias_dps, "deg/s", -200, 200, "measured rate at rest, sign applied");
  table.number("bias_uncertainty_dps", &Gyro::bias_uncertainty_dps, "deg/s", 0, 200, deviation);
  table.date("bias_measured_utc", &Gyro::bias_measured_utc, measured);
}

void add_text_columns(Fields& fields) {
  using Text = TextColumns;
  constexpr int last = 63;
  const auto rate = [](std::size_t axis) {
    return [=](auto& text) -> auto& {
      return text.rate[axis];
    };
  };
  Table<Text> table(fields, "gyro.text", [](const RigProfile& rig) -> const Text& { return rig.gyro.text; });
  table.text("prefix", &Text::prefix, "lines must start with it; empty: any line");
  table.number("x_column", rate(0), "1", -1, last, "columns from 0; -1: not sent");
  table.number("y_column", rate(1), "1", -1, last, "likewise");
  table.number("z_column", rate(2), "1", -1, last, "likewise");
  table.number("scale_dps", &Text::scale_dps, "deg/s", 1e-9, 1e6, "degrees per second of one unit");
  table.number("time_column", &Text::time, "1", -1, last, "column of the device's time; -1: none");
  table.number("time_unit_s", &Text::time_unit_s, "s", 1e-9, 1, "seconds of one unit of it");
}

void add_servo(Fields& fields) {
  using Servo = ServoProfile;
  constexpr double shortest_us = SERVO_LIMIT_PULSE_MIN_US, longest_us = SERVO_LIMIT_PULSE_MAX_US;
  constexpr double rate_max = SERVO_LIMIT_RATE_CDPS / 100.0, span_max = SERVO_LIMIT_SPAN / 100.0;
  add_link(fields, "servo", Device::servo);
  Table<Servo> table(fields, "servo", &RigProfile::servo);
  table.text("model", &Servo::model, "free text");
  const Words protocols = sensors::servo_protocol_names();
  table.text("protocol", &Servo::protocol, any_of(protocols), protocols);
  table.number("bus_id", &Servo::bus_id, "1", 0, 251, "of a servo on a bus (dynamixel, sts3215): its ID");
  table.choice("kind", &Servo::kind, {"positional", "continuous", "none"},
               "positional, continuous or none: nobody commands what turns the rig");
  table.number("travel_deg", &Servo::travel_deg, "deg", 0, span_max,
               "positional: angle from shortest to longest pulse; continuous: what its cable bears, 0: any");
  table.number("full_rate_dps", &Servo::full_rate_dps, "deg/s", 0, span_max / 2,
               "continuous: speed at the longest pulse");
  table.number("pulse_min_us", &Servo::pulse_min_us, "us", shortest_us, longest_us, "shortest pulse");
  table.number("pulse_max_us", &Servo::pulse_max_us, "us", shortest_us, longest_us, "longest pulse");
  table.number("max_rate_dps", &Servo::max_rate_dps, "deg/s", 0.1, rate_max, "never commanded beyond");
  table.number("acceleration_dps2", &Servo::acceleration_dps2, "deg/s^2", SERVO_LIMIT_ACCELERATION_MIN_DPS2,
               SERVO_LIMIT_ACCELERATION_DPS2, "of every ramp");
  table.number("stop_margin_deg", &Servo::stop_margin_deg, "deg", 0, 1000,
               "kept from either end of the travel");
  table.number("settle_s", &Servo::settle_s, "s", 0, 10, "after a change of speed, until the shaft follows");
  table.number("loop_hz", &Servo::loop_hz, "Hz", 0.5, 100,
               "bandwidth of the servo's own loop, until a recording tells better");
  table.number("scale", &Servo::scale, "1", 0.5, 2, "shaft angle per commanded angle");
  table.number("scale_uncertainty", &Servo::scale_uncertainty, "1", 0, 1, deviation);
  table.date("scale_measured_utc", &Servo::scale_measured_utc, measured);
}

void add_encoder(Fields& fields) {
  using Encoder = EncoderProfile;
  constexpr double largest_deg = 20.0;
  Table<Encoder> table(fields, "encoder", &RigProfile::encoder);
  table.number("latency_s", &Encoder::latency_s, "s", -0.1, 0.1,
               "constant delay from the shaft's angle to the time of its reading");
  table.number("latency_uncertainty_s", &Encoder::latency_uncertainty_s, "s", 0, 0.1, deviation);
  table.number("sign", &Encoder::sign, "1", -1, 1, "1 or -1: a positive command then makes the angle grow");
  table.number("offset_deg", &Encoder::offset_deg, "deg", -360, 360,
               "where the shaft stands, by the command, when the sensor sends 0");
  const auto error = [&](const char* name, double Encoder::*member, const char* help) {
    table.number(name, member, "deg", -largest_deg, largest_deg, help);
  };
  error("once_cosine_deg", &Encoder::once_cosine_deg, "error once a turn: sent - true, by the cosine");
  error("once_sine_deg", &Encoder::once_sine_deg, "by the sine of the angle sent");
  error("twice_cosine_deg", &Encoder::twice_cosine_deg, "error twice a turn, likewise");
  error("twice_sine_deg", &Encoder::twice_sine_deg, "likewise");
  table.number("error_deg", &Encoder::error_deg, "deg", 0, largest_deg,
               "what of such errors is left, root mean square");
  table.date("measured_utc", &Encoder::measured_utc,
             "when these were calibrated, UTC; empty: assumptions, no label is made from them");
}

ProfileField setting_field(const std::string& table, const sensors::GyroSetting& setting) {
  ProfileField field{
      .table = table, .name = setting.name, .help = setting.comment, .min = setting.min, .max = setting.max};
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
  static const Fields fields = [] {
    Fields list;
    Table<RigProfile>(list, "", std::identity()).text("name", &RigProfile::name, "how this rig is called");
    add_camera(list);
    add_gyro(list);
    add_text_columns(list);
    add_servo(list);
    add_encoder(list);
    return list;
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
