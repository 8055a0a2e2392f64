// SPDX-License-Identifier: MIT
// The servo link's golden vectors, which the firmware's tests read as well: protocols/vectors/servo_link.txt.
#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <sstream>
#include <string>

#include "scan.h"
#include "support/telemetry_bytes.h"
#include "support/vectors.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::test {
namespace {

/// One message of a vector's meaning: "run 5 leg=1 rate_cdps=2000 ...".
struct Described {
  std::string type;
  std::uint8_t sequence = 0;
  std::map<std::string, std::int64_t> fields;

  std::int64_t operator[](const std::string& field) const { return fields.at(field); }
  double hundredths(const std::string& field) const { return static_cast<double>(fields.at(field)) / 100.0; }
};

Described described(const std::string& meaning) {
  Described message;
  unsigned sequence = 0;
  std::istringstream(meaning) >> message.type >> sequence;
  message.sequence = static_cast<std::uint8_t>(sequence);
  for (const auto& [name, value] : fields_of(meaning)) message.fields[name] = std::stoll(value);
  return message;
}

wire::ServoMessage expected_message(const Described& message) {
  const auto u8 = [&](const char* name) { return static_cast<std::uint8_t>(message[name]); };
  const auto u16 = [&](const char* name) { return static_cast<std::uint16_t>(message[name]); };
  const auto u32 = [&](const char* name) { return static_cast<std::uint32_t>(message[name]); };
  wire::ServoMessage expected;
  expected.sequence = message.sequence;
  if (message.type == "telemetry") {
    const bool fine = (u8("motion") & SERVO_FINE_TICKS) != 0;
    const unsigned ticks_per_us = fine ? SERVO_TICKS_PER_US : SERVO_COARSE_TICKS_PER_US;
    expected.body =
        ServoState{.mcu_us = u32("mcu_us"),
                   .angle_deg = message.hundredths("angle_cdeg"),
                   .rate_dps = message.hundredths("rate_cdps"),
                   .pulse_us = static_cast<float>(u16("pulse_ticks")) / static_cast<float>(ticks_per_us),
                   .motion = static_cast<ServoMotion>(u8("motion") & ~SERVO_FINE_TICKS),
                   .fault = static_cast<ServoFault>(message["fault"]),
                   .leg = u16("leg")};
  } else if (message.type == "welcome") {
    std::ostringstream firmware;
    firmware << message["firmware_major"] << '.' << message["firmware_minor"] << '.'
             << message["firmware_patch"];
    expected.body =
        wire::ServoWelcome{.version = u8("version"),
                           .firmware = firmware.str(),
                           .board = u8("board"),
                           .reset_cause = u8("reset_cause"),
                           .uptime_us = u32("uptime_us"),
                           .limit_pulse_min_us = static_cast<double>(message["limit_pulse_min_us"]),
                           .limit_pulse_max_us = static_cast<double>(message["limit_pulse_max_us"]),
                           .limit_rate_dps = message.hundredths("limit_rate_cdps"),
                           .limit_acceleration_dps2 = static_cast<double>(message["limit_acceleration_dps2"]),
                           .watchdog_ms = static_cast<unsigned>(message["watchdog_ms"])};
  } else if (message.type == "ack") {
    expected.body = wire::ServoAck{.type = u8("type"), .mcu_us = u32("mcu_us")};
  } else if (message.type == "nack") {
    expected.body = wire::ServoNack{.type = u8("type"), .reason = u8("reason"), .detail = u8("detail")};
  } else if (message.type == "pong") {
    expected.body =
        wire::ServoPong{.token = u32("token"), .receive_us = u32("receive_us"), .send_us = u32("send_us")};
  } else if (message.type == "shaft") {
    const std::uint8_t status = u8("status");
    expected.body = ShaftReading{.mcu_us = u32("mcu_us"),
                                 .angle_deg = static_cast<double>(message["raw"]) * 360.0 / 4096.0,
                                 .uncertainty_deg = 0.05F,
                                 .status = status == 0x01   ? ShaftStatus::silent
                                           : status == 0x20 ? ShaftStatus::good
                                           : status == 0x30 ? ShaftStatus::weak
                                           : status == 0x28 ? ShaftStatus::strong
                                                            : ShaftStatus::absent,
                                 .gain = u16("gain")};
  } else {
    expected.body = wire::ServoEvent{.kind = u8("kind"), .detail = u16("detail"), .mcu_us = u32("mcu_us")};
  }
  return expected;
}

ServoProfile profile_of(const Described& configure) {
  ServoProfile servo;
  servo.kind = static_cast<ServoKind>(configure["kind"]);
  servo.pulse_min_us = static_cast<double>(configure["pulse_min_us"]);
  servo.pulse_max_us = static_cast<double>(configure["pulse_max_us"]);
  servo.travel_deg = configure.hundredths("span");
  servo.full_rate_dps = configure.hundredths("span") / 2.0;
  servo.max_rate_dps = configure.hundredths("limit_rate_cdps");
  servo.acceleration_dps2 = static_cast<double>(configure["limit_acceleration_dps2"]);
  servo.stop_margin_deg = servo.travel_deg / 2.0 - configure.hundredths("angle_max_cdeg");
  return servo;
}

/// The bytes that the host sends for a described command; none if it is not one that this host sends.
std::optional<ByteVector> command_bytes(const Described& message) {
  const std::uint8_t sequence = message.sequence;
  if (message.type == "hello" && message["version"] == SERVO_LINK_VERSION) return wire::hello_bytes(sequence);
  if (message.type == "hello_asking") return wire::asking_hello_bytes(sequence);
  if (message.type == "configure") return wire::configure_bytes(sequence, profile_of(message));
  if (message.type == "arm") return wire::arm_bytes(sequence, message.hundredths("angle_cdeg"));
  if (message.type == "disarm") return wire::disarm_bytes(sequence);
  if (message.type == "halt") return wire::halt_bytes(sequence);
  if (message.type == "refresh") return wire::refresh_bytes();
  if (message.type == "ping")
    return wire::ping_bytes(static_cast<std::uint32_t>(message["token"]),
                            static_cast<std::uint16_t>(message["delay_max_us"]));
  if (message.type == "run")
    return wire::run_bytes(sequence, {.leg = static_cast<std::uint16_t>(message["leg"]),
                                      .turn_back = (message["flags"] & SERVO_RUN_TURN_BACK) != 0,
                                      .rate_dps = message.hundredths("rate_cdps"),
                                      .acceleration_dps2 = static_cast<double>(message["acceleration_dps2"]),
                                      .duration_s = static_cast<double>(message["duration_ms"]) / 1000.0});
  if (message.type == "go_to")
    return wire::go_to_bytes(sequence,
                             {.angle_deg = message.hundredths("angle_cdeg"),
                              .rate_dps = message.hundredths("rate_cdps"),
                              .acceleration_dps2 = static_cast<double>(message["acceleration_dps2"])});
  return std::nullopt;
}

std::vector<GoldenVector> single_frames() {
  std::vector<GoldenVector> frames;
  for (GoldenVector& vector : read_vectors("servo_link.txt"))
    if (!vector.name.starts_with("stream_")) frames.push_back(std::move(vector));
  return frames;
}

TEST(ServoVectors, MessagesOfTheServoDecodeToTheirFields) {
  int checked = 0;
  for (const GoldenVector& vector : single_frames()) {
    if (vector.bytes.at(1) < SERVO_WELCOME) continue;
    SCOPED_TRACE(vector.name);
    const auto scan = scan_any_chunking<wire::ServoMessage>(wire::ServoScanner(), vector.bytes);
    ASSERT_EQ(scan.messages.size(), 1U);
    wire::ServoMessage expected = expected_message(described(vector.meaning));
    expected.span = {0, vector.bytes.size()};
    EXPECT_TRUE(same(scan.messages[0], expected));
    ++checked;
  }
  EXPECT_GE(checked, 10);
}

TEST(ServoVectors, CommandsEncodeToTheirBytes) {
  int checked = 0;
  for (const GoldenVector& vector : single_frames()) {
    const auto bytes = command_bytes(described(vector.meaning));
    if (!bytes) continue;
    EXPECT_EQ(*bytes, vector.bytes) << vector.name;
    ++checked;
  }
  EXPECT_GE(checked, 20);
}

TEST(ServoVectors, TelemetryEncodesToItsBytesWithFineTicks) {
  int checked = 0;
  for (const GoldenVector& vector : single_frames()) {
    const Described message = described(vector.meaning);
    if (message.type != "telemetry" || (message["motion"] & SERVO_FINE_TICKS) == 0) continue;
    const auto state = std::get<ServoState>(expected_message(message).body);
    EXPECT_EQ(test::telemetry_bytes(message.sequence, state), vector.bytes) << vector.name;
    ++checked;
  }
  EXPECT_GE(checked, 3);
}

/// The same three states, as firmware 1.0 and as later ones say them.
TEST(ServoVectors, TelemetryOfBothTicksTellsTheSameStates) {
  std::map<std::string, ServoState> states;
  for (const GoldenVector& vector : single_frames())
    if (const Described message = described(vector.meaning); message.type == "telemetry")
      states[vector.name] = std::get<ServoState>(expected_message(message).body);
  for (const std::string kind : {"disarmed", "steady", "fault"}) {
    const ServoState &coarse = states.at("telemetry_" + kind), &fine = states.at("telemetry_fine_" + kind);
    EXPECT_NEAR(coarse.pulse_us, fine.pulse_us, 0.26) << kind;
    EXPECT_EQ(coarse.motion, fine.motion) << kind;
    EXPECT_EQ(coarse.angle_deg, fine.angle_deg) << kind;
  }
}

/// How many of the things that a stream's meaning lists start with `word`.
int listed(const std::string& meaning, const std::string& word) {
  int count = 0;
  std::istringstream in(meaning);
  for (std::string item; std::getline(in, item, ';');)
    if (described(item).type == word) ++count;
  return count;
}

TEST(ServoVectors, DamagedStreamsAreCountedAsDescribed) {
  for (const GoldenVector& vector : read_vectors("servo_link.txt")) {
    if (!vector.name.starts_with("stream_")) continue;
    SCOPED_TRACE(vector.name);
    const auto scan = scan_any_chunking<wire::ServoMessage>(wire::ServoScanner(), vector.bytes);
    // The good frames in them are the host's commands or unknown: no messages for the host.
    const std::string& meaning = vector.meaning;
    const int foreign = listed(meaning, "halt") + listed(meaning, "refresh") + listed(meaning, "unknown") +
                        listed(meaning, "wrong_length");
    EXPECT_TRUE(scan.messages.empty());
    const bool cut_by_stop = meaning.starts_with("stop ;");
    EXPECT_EQ(scan.counters.bad_value + scan.counters.bad_length + scan.counters.bad_checksum,
              static_cast<std::uint64_t>(foreign + listed(meaning, "bad") + (cut_by_stop ? 1 : 0)));
    // A last flag waits: it may open the next frame.
    EXPECT_LE(scan.counters.bytes_pending, meaning == "nothing" ? vector.bytes.size() : 1);
  }
}

}  // namespace
}  // namespace thermorig::test
