// SPDX-License-Identifier: MIT
#include "thermorig/learning/interchange/formats.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "facts.h"
#include "mcap_writer.h"
#include "thermorig/core/base64.h"
#include "thermorig/core/validity.h"

namespace thermorig::interchange {

namespace {

using Json = nlohmann::ordered_json;

Json object_of(std::initializer_list<std::pair<const char*, Json>> properties) {
  Json object{{"type", "object"}, {"properties", Json::object()}};
  for (const auto& [name, schema] : properties) object["properties"][name] = schema;
  return object;
}

Json of_type(const char* type, const char* description = "") {
  Json schema{{"type", type}};
  if (*description != '\0') schema["description"] = description;
  return schema;
}

/// A number, or null where it is not known.
Json measured(const char* description) {
  return {{"type", {"number", "null"}}, {"description", description}};
}

Json time_with(const char* nanoseconds) {
  return object_of({{"sec", of_type("integer")}, {nanoseconds, of_type("integer")}});
}

Json axes_of(const char* description) {
  Json axes = object_of({{"x", measured("")}, {"y", measured("")}, {"z", measured("")}});
  axes["description"] = description;
  return axes;
}

Json list_of(const char* type) {
  return {{"type", "array"}, {"items", {{"type", type}}}};
}

McapChannel channel_of(const char* topic, const char* name, Json schema) {
  schema["title"] = name;
  return {topic, name, schema.dump()};
}

McapChannel camera_channel() {
  Json data{{"type", "string"}, {"contentEncoding", "base64"}};
  data["description"] = "degrees Celsius, float32, row by row, as the camera sent them";
  return channel_of("/camera", "foxglove.RawImage",
                    object_of({{"timestamp", time_with("nsec")},
                               {"frame_id", of_type("string")},
                               {"width", of_type("integer")},
                               {"height", of_type("integer")},
                               {"encoding", of_type("string")},
                               {"step", of_type("integer", "bytes of a row")},
                               {"data", data}}));
}

McapChannel gyro_channel() {
  Json orientation = axes_of("not measured");
  orientation["properties"]["w"] = of_type("number");
  return channel_of(
      "/gyro", "sensor_msgs/Imu",
      object_of({{"header", object_of({{"stamp", time_with("nanosec")}, {"frame_id", of_type("string")}})},
                 {"orientation", orientation},
                 {"orientation_covariance", list_of("number")},
                 {"angular_velocity", axes_of("rad/s, as the device sent it")},
                 {"angular_velocity_covariance", list_of("number")},
                 {"linear_acceleration", axes_of("not measured")},
                 {"linear_acceleration_covariance", list_of("number")},
                 {"rate_dps", measured("deg/s about the servo's axis, bias in it")}}));
}

McapChannel servo_channel() {
  return channel_of("/servo", "thermorig.Servo",
                    object_of({{"timestamp", time_with("nsec")},
                               {"angle_commanded_deg", measured("deg")},
                               {"rate_commanded_dps", measured("deg/s")},
                               {"pulse_us", measured("us; 0: no pulse")},
                               {"leg", of_type("integer", "that is driven; 0: none")}}));
}

McapChannel shaft_channel() {
  return channel_of(
      "/shaft", "thermorig.Shaft",
      object_of(
          {{"timestamp", time_with("nsec")},
           {"angle_deg", measured("deg, turns counted since readings were lost; null: no angle")},
           {"uncertainty_deg", measured("deg, of one reading, one standard deviation")},
           {"status", of_type("integer",
                              "0 good; 1 its signal is weak, 2 too strong; 3 there is none, 4 no answer")}}));
}

McapChannel label_channel(bool has_measured_shaft) {
  Json label =
      object_of({{"timestamp", time_with("nsec")},
                 {"frame", of_type("integer", "index into the messages of /camera")},
                 {"rate_commanded_dps", measured("deg/s over the frame's exposure: the label of trainings")},
                 {"rate_shaft_dps",
                  measured("deg/s of the shaft: measured where that is believed, else by the servo's model")},
                 {"rate_shaft_uncertainty_dps", measured("deg/s, one standard deviation")},
                 {"rate_gyro_dps", measured("deg/s, mean over the exposure, bias in it")},
                 {"angle_commanded_deg", measured("deg")},
                 {"valid", of_type("boolean")},
                 {"reasons", list_of("string")},
                 {"leg", of_type("integer")},
                 {"run", of_type("integer", "unbroken run of valid frames; 0: none")}});
  if (has_measured_shaft) {
    label["properties"]["rate_measured_dps"] = measured("deg/s of the shaft by the sensor on it");
    label["properties"]["rate_measured_uncertainty_dps"] = measured("deg/s, one standard deviation");
    label["properties"]["angle_measured_deg"] = measured("deg, at the label's time");
  }
  return channel_of("/label", "thermorig.Label", std::move(label));
}

McapChannel event_channel() {
  return channel_of("/events", "foxglove.Log",
                    object_of({{"timestamp", time_with("nsec")},
                               {"level", of_type("integer")},
                               {"message", of_type("string")},
                               {"name", of_type("string")},
                               {"file", of_type("string")},
                               {"line", of_type("integer")}}));
}

/// The channels of a session: images as foxglove.RawImage, rotation as sensor_msgs/Imu, telemetry, labels,
/// events as foxglove.Log, in this order; then readings of the shaft, where there are some.
std::vector<McapChannel> mcap_channels(bool has_measured_shaft) {
  std::vector<McapChannel> channels{camera_channel(), gyro_channel(), servo_channel(),
                                    label_channel(has_measured_shaft), event_channel()};
  if (has_measured_shaft) channels.push_back(shaft_channel());
  return channels;
}

using Json = nlohmann::ordered_json;

constexpr double rad_per_deg = std::numbers::pi / 180.0;

Json timestamp(std::uint64_t ns) {
  return {{"sec", ns / second_ns}, {"nsec", ns % second_ns}};
}

/// JSON knows no number that is none: null.
Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

Json image(const TimedFrame& frame, std::uint64_t ns) {
  const std::array<float, frame_pixels>& temp_c = frame.frame.temp_c;
  const std::span pixels(reinterpret_cast<const std::uint8_t*>(temp_c.data()), sizeof(temp_c));
  return {{"timestamp", timestamp(ns)}, {"frame_id", "camera"}, {"width", frame_columns},
          {"height", frame_rows},       {"encoding", "32FC1"},  {"step", frame_columns * sizeof(float)},
          {"data", base64(pixels)}};
}

/// As sensor_msgs/Imu says it: a covariance that begins with -1 means that there is no such value.
Json rotation(const TimedGyro& sample, std::uint64_t ns) {
  const auto& rate = sample.reading.rate_dps;
  const auto axis = [&](std::size_t i) { return number(static_cast<double>(rate[i]) * rad_per_deg); };
  static const Json none{-1, 0, 0, 0, 0, 0, 0, 0, 0}, unknown{0, 0, 0, 0, 0, 0, 0, 0, 0};
  return {
      {"header", {{"stamp", {{"sec", ns / second_ns}, {"nanosec", ns % second_ns}}}, {"frame_id", "gyro"}}},
      {"orientation", {{"x", 0}, {"y", 0}, {"z", 0}, {"w", 1}}},
      {"orientation_covariance", none},
      {"angular_velocity", {{"x", axis(0)}, {"y", axis(1)}, {"z", axis(2)}}},
      {"angular_velocity_covariance", unknown},
      {"linear_acceleration", {{"x", 0}, {"y", 0}, {"z", 0}}},
      {"linear_acceleration_covariance", none},
      {"rate_dps", number(sample.rate_dps)}};
}

Json telemetry(const TimedServo& servo, std::uint64_t ns) {
  return {{"timestamp", timestamp(ns)},
          {"angle_commanded_deg", number(servo.state.angle_deg)},
          {"rate_commanded_dps", number(servo.state.rate_dps)},
          {"pulse_us", number(servo.state.pulse_us)},
          {"leg", servo.state.leg}};
}

Json shaft(const TimedShaft& shaft, std::uint64_t ns) {
  return {{"timestamp", timestamp(ns)},
          {"angle_deg", number(shaft.angle_deg)},
          {"uncertainty_deg", number(shaft.reading.uncertainty_deg)},
          {"status", static_cast<int>(shaft.reading.status)}};
}

Json label(const LabelledSample& sample, std::uint64_t ns) {
  Json reasons = Json::array();
  for (std::uint32_t i = 0; i < reason_count; ++i)
    if ((sample.reason_bits >> i & 1U) != 0) reasons.push_back(reason_names[i]);
  return {{"timestamp", timestamp(ns)},
          {"frame", sample.frame_index},
          {"rate_commanded_dps", number(sample.rate_commanded_dps)},
          {"rate_shaft_dps", number(sample.rate_shaft_dps)},
          {"rate_shaft_uncertainty_dps", number(sample.rate_shaft_uncertainty_dps)},
          {"rate_gyro_dps", number(sample.rate_gyro_dps)},
          {"angle_commanded_deg", number(sample.angle_commanded_deg)},
          {"valid", sample.valid},
          {"reasons", reasons},
          {"leg", sample.leg},
          {"run", sample.run}};
}

Json label_with_shaft(const LabelledSample& sample, std::uint64_t ns) {
  Json all = label(sample, ns);
  all["rate_measured_dps"] = number(sample.rate_measured_dps);
  all["rate_measured_uncertainty_dps"] = number(sample.rate_measured_uncertainty_dps);
  all["angle_measured_deg"] = number(sample.angle_measured_deg);
  return all;
}

/// As foxglove.Log says it: 2 is information, 3 a warning.
Json log_entry(const RecordingEvent& event, std::uint64_t ns) {
  const bool is_warning = event.kind == EventKind::warning || event.kind == EventKind::device_lost ||
                          event.kind == EventKind::servo_fault || event.kind == EventKind::missing;
  return {{"timestamp", timestamp(ns)},
          {"level", is_warning ? 3 : 2},
          {"message", event.message},
          {"name", event_kind_names[static_cast<std::size_t>(event.kind)]},
          {"file", event.source ? name_of(*event.source) : "host"},
          {"line", 0}};
}

/// The rows of a table as messages of a channel, one after another.
class Stream {
 public:
  template <typename Row, typename Time, typename Message>
  Stream(const RecordingHeader& header, const std::vector<Row>& rows, Time time, Message message)
      : count_(rows.size()),
        time_ns_([&header, &rows, time](std::size_t i) { return unix_ns(header, time(rows[i])); }),
        text_([&header, &rows, time, message](std::size_t i) {
          return message(rows[i], unix_ns(header, time(rows[i])))
              .dump(-1, ' ', true, Json::error_handler_t::replace);
        }) {}

  /// Of the next message; the largest number where there is none.
  std::uint64_t time_ns() const {
    return next_ < count_ ? time_ns_(next_) : std::numeric_limits<std::uint64_t>::max();
  }
  bool is_done() const { return next_ >= count_; }
  void write_next(std::size_t channel, McapWriter& writer) {
    writer.add(channel, time_ns(), text_(next_));
    ++next_;
  }

 private:
  std::size_t count_, next_ = 0;
  std::function<std::uint64_t(std::size_t)> time_ns_;
  std::function<std::string(std::size_t)> text_;
};

std::vector<Stream> streams_of(const session::Session& session) {
  const RecordingHeader& header = session.raw.header;
  const auto stamped = [](const auto& row) { return row.stamp.time; };
  const auto timed = [](const auto& row) { return row.time; };
  const bool measures = has_measured_shaft(session.raw);
  std::vector<Stream> streams{Stream(header, session.frames, stamped, image),
                              Stream(header, session.gyro, stamped, rotation),
                              Stream(header, session.servo, stamped, telemetry),
                              Stream(header, session.samples, timed, measures ? label_with_shaft : label),
                              Stream(header, session.raw.events, timed, log_entry)};
  if (measures) streams.emplace_back(header, session.shaft, stamped, shaft);
  return streams;
}

std::map<std::string, std::string> texts_of(const nlohmann::json& facts) {
  std::map<std::string, std::string> texts;
  for (const auto& [key, value] : facts.items())
    texts[key] = value.is_string() ? value.get<std::string>() : value.dump();
  return texts;
}

}  // namespace

void write_mcap(const session::Session& session, Sink& sink, McapCompression compression) {
  McapWriter writer(sink, compression, session.raw.header.creator,
                    mcap_channels(has_measured_shaft(session.raw)), texts_of(facts_of(session)));
  std::vector<Stream> streams = streams_of(session);
  while (true) {
    const auto first =
        std::min_element(streams.begin(), streams.end(), [](const Stream& one, const Stream& other) {
          return !one.is_done() && (other.is_done() || one.time_ns() < other.time_ns());
        });
    if (first->is_done()) break;
    first->write_next(static_cast<std::size_t>(first - streams.begin()), writer);
  }
  writer.finish();
}

}  // namespace thermorig::interchange
