// SPDX-License-Identifier: MIT
#include "mcap_schemas.h"

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <utility>

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
      object_of({{"timestamp", time_with("nsec")},
                 {"angle_deg", measured("deg, turns counted; null: the sensor has no angle")},
                 {"uncertainty_deg", measured("deg, of one reading, one standard deviation")},
                 {"trusts_itself", of_type("boolean", "what it measures by is strong enough")}}));
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

}  // namespace

std::vector<McapChannel> mcap_channels(bool has_measured_shaft) {
  std::vector<McapChannel> channels{camera_channel(), gyro_channel(), servo_channel(),
                                    label_channel(has_measured_shaft), event_channel()};
  if (has_measured_shaft) channels.push_back(shaft_channel());
  return channels;
}

}  // namespace thermorig::interchange
