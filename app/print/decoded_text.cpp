// SPDX-License-Identifier: MIT
#include "decoded_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "output.h"
#include "thermorig/sensors/wire/counter_names.h"

namespace thermorig::app {

namespace {

constexpr const char* motion_names[] = {"disarmed", "holding", "ramping", "steady", "stopping"};
constexpr const char* fault_names[] = {"none", "watchdog", "stop byte", "limit", "bad frames"};
constexpr const char* shaft_status_names[] = {"good", "weak signal", "too strong a signal",
                                              "nothing to measure", "no answer"};

template <typename Enum, std::size_t count>
std::string name_in(const char* const (&names)[count], Enum value) {
  const auto number = static_cast<std::size_t>(value);
  return number < count ? names[number] : fmt::format("unknown {}", number);
}

/// A float as the wire had it: in hundredths.
double hundredths(float value) {
  return std::round(static_cast<double>(value) * 100) / 100;
}

struct Span {
  double min, max, mean;
};

Span span_of(const ThermalFrame& frame) {
  const auto [min, max] = std::minmax_element(frame.temp_c.begin(), frame.temp_c.end());
  const double sum = std::accumulate(frame.temp_c.begin(), frame.temp_c.end(), 0.0);
  return {*min, *max, sum / static_cast<double>(frame_pixels)};
}

std::string place(const char* what, std::uint64_t index, const StreamSpan& span) {
  return fmt::format("{} {:<4} byte {:<5} ", what, index, span.begin);
}

std::string body_text(const ServoState& state) {
  return fmt::format("{:>9.6f} s {:+7.2f} deg {:+7.2f} deg/s pulse {:6.1f} us {}{}{}", state.mcu_us * 1e-6,
                     state.angle_deg, state.rate_dps, state.pulse_us, name_in(motion_names, state.motion),
                     state.leg > 0 ? fmt::format("  leg {}", state.leg) : "",
                     state.fault == ServoFault::none ? "" : "  FAULT " + name_in(fault_names, state.fault));
}

std::string body_text(const wire::ServoWelcome& welcome) {
  return fmt::format(
      "welcome: firmware {}, link version {}, limits +-{:.0f} deg/s, {:.0f} deg/s^2, {:.0f}..{:.0f} us",
      welcome.firmware, welcome.version, welcome.limit_rate_dps, welcome.limit_acceleration_dps2,
      welcome.limit_pulse_min_us, welcome.limit_pulse_max_us);
}

std::string body_text(const wire::ServoAck& ack) {
  return "ack of " + wire::command_name(ack.type);
}

std::string body_text(const wire::ServoNack& nack) {
  return fmt::format("nack of {}: {} (detail {})", wire::command_name(nack.type),
                     wire::reason_text(nack.reason), nack.detail);
}

std::string body_text(const wire::ServoPong& pong) {
  return fmt::format("pong {}: received at {} us, sent at {} us", pong.token, pong.receive_us, pong.send_us);
}

std::string body_text(const wire::ServoEvent& event) {
  return "event: " + wire::event_text(event);
}

std::string body_text(const wire::ServoReply& reply) {
  return fmt::format("answer of {}: {} bytes{}", reply.id, reply.data.size(),
                     reply.error == 0 ? std::string() : fmt::format(", error {}", reply.error));
}

std::string body_text(const ShaftReading& reading) {
  return fmt::format(
      "shaft {:>12.6f} s  {:9.3f} deg{}", reading.mcu_us * 1e-6, reading.angle_deg,
      reading.status == ShaftStatus::good ? "" : "  " + name_in(shaft_status_names, reading.status));
}

nlohmann::json body_json(const ServoState& state) {
  return {{"event", "telemetry"},
          {"mcu_us", state.mcu_us},
          {"angle_deg", state.angle_deg},
          {"rate_dps", state.rate_dps},
          {"pulse_us", state.pulse_us},
          {"motion", name_in(motion_names, state.motion)},
          {"fault", name_in(fault_names, state.fault)},
          {"leg", state.leg}};
}

nlohmann::json body_json(const wire::ServoWelcome& welcome) {
  return {{"event", "welcome"},
          {"link_version", welcome.version},
          {"firmware", welcome.firmware},
          {"limit_rate_dps", welcome.limit_rate_dps},
          {"limit_acceleration_dps2", welcome.limit_acceleration_dps2},
          {"watchdog_ms", welcome.watchdog_ms}};
}

nlohmann::json body_json(const wire::ServoAck& ack) {
  return {{"event", "ack"}, {"command", wire::command_name(ack.type)}, {"mcu_us", ack.mcu_us}};
}

nlohmann::json body_json(const wire::ServoNack& nack) {
  return {{"event", "nack"},
          {"command", wire::command_name(nack.type)},
          {"reason", wire::reason_text(nack.reason)},
          {"detail", nack.detail}};
}

nlohmann::json body_json(const wire::ServoPong& pong) {
  return {
      {"event", "pong"}, {"token", pong.token}, {"receive_us", pong.receive_us}, {"send_us", pong.send_us}};
}

nlohmann::json body_json(const wire::ServoEvent& event) {
  return {{"event", "servo_event"}, {"text", wire::event_text(event)}, {"mcu_us", event.mcu_us}};
}

nlohmann::json body_json(const wire::ServoReply& reply) {
  return {{"event", "answer"}, {"id", reply.id}, {"error", reply.error}, {"data", reply.data}};
}

nlohmann::json body_json(const ShaftReading& reading) {
  return {{"event", "shaft"},
          {"mcu_us", reading.mcu_us},
          {"angle_deg", reading.angle_deg},
          {"status", name_in(shaft_status_names, reading.status)}};
}

}  // namespace

std::string text_of(const wire::CameraMessage& message, std::uint64_t index) {
  const Span span = span_of(message.frame);
  return place("frame", index, message.span) +
         fmt::format("{:7.2f}..{:.2f} degC  mean {:.2f}  sensor {:.2f} degC{}", span.min, span.max, span.mean,
                     message.frame.sensor_temp_c, message.resync_before ? "  after a resync" : "");
}

std::string text_of(const wire::GyroMessage& message, std::uint64_t index) {
  const GyroReading& reading = message.reading;
  std::string text = place("sample", index, message.span) +
                     fmt::format("x {:+9.3f}  y {:+9.3f}  z {:+9.3f} deg/s", reading.rate_dps[0],
                                 reading.rate_dps[1], reading.rate_dps[2]);
  if (reading.temp_c) text += fmt::format("  {:.2f} degC", *reading.temp_c);
  if (reading.device_time_us)
    text += fmt::format("  {:.6f} s", static_cast<double>(*reading.device_time_us) * 1e-6);
  if (reading.saturated) text += "  saturated";
  return text + (message.lost_before ? "  after a loss" : "");
}

std::string text_of(const wire::ServoMessage& message, std::uint64_t index) {
  return place("message", index, message.span) +
         printable(std::visit([](const auto& body) { return body_text(body); }, message.body)) +
         (message.lost_before ? "  after a loss" : "");
}

nlohmann::json message_json(const wire::CameraMessage& message, std::uint64_t index) {
  nlohmann::json temp_c = nlohmann::json::array();
  for (float pixel : message.frame.temp_c) temp_c.push_back(hundredths(pixel));
  return {{"event", "frame"},
          {"index", index},
          {"byte", message.span.begin},
          {"resync_before", message.resync_before},
          {"sensor_temp_c", hundredths(message.frame.sensor_temp_c)},
          {"temp_c", std::move(temp_c)}};
}

nlohmann::json message_json(const wire::GyroMessage& message, std::uint64_t index) {
  const GyroReading& reading = message.reading;
  nlohmann::json object{{"event", "sample"},
                        {"index", index},
                        {"byte", message.span.begin},
                        {"lost_before", message.lost_before},
                        {"rate_dps", reading.rate_dps},
                        {"saturated", reading.saturated},
                        {"temp_c", nullptr},
                        {"device_time_us", nullptr}};
  if (reading.temp_c) object["temp_c"] = hundredths(*reading.temp_c);
  if (reading.device_time_us) object["device_time_us"] = *reading.device_time_us;
  return object;
}

nlohmann::json message_json(const wire::ServoMessage& message, std::uint64_t index) {
  nlohmann::json object = std::visit([](const auto& body) { return body_json(body); }, message.body);
  object["index"] = index;
  object["byte"] = message.span.begin;
  object["sequence"] = message.sequence;
  object["lost_before"] = message.lost_before;
  return object;
}

nlohmann::json counters_json(const wire::Counters& counters) {
  nlohmann::json object;
  for (const auto& counter : wire::counter_names) object[counter.name] = counters.*counter.member;
  return object;
}

std::string text_of(const wire::Counters& counters) {
  Table bytes({">bytes", ">in messages", ">damaged", ">skipped", ">pending"});
  bytes.add({count_text(counters.bytes_received), count_text(counters.bytes_in_messages),
             count_text(counters.bytes_in_damaged), count_text(counters.bytes_skipped),
             count_text(counters.bytes_pending)});
  Table messages(
      {">messages", ">replies", ">bad checksum", ">bad length", ">bad value", ">lost", ">resyncs"});
  messages.add({count_text(counters.messages), count_text(counters.replies),
                count_text(counters.bad_checksum), count_text(counters.bad_length),
                count_text(counters.bad_value), count_text(counters.lost), count_text(counters.resyncs)});
  return bytes.text() + messages.text();
}

}  // namespace thermorig::app
