// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "mavlink.h"
#include "support/gyro_scanners.h"
#include "support/vectors.h"
#include "thermorig/core/error.h"
#include "wire/scan.h"

namespace thermorig::test {
namespace {

using ::testing::HasSubstr;
using wire::GyroMessage;

/// CRC-16/MCRF4XX by its definition: a register that is shifted bit by bit, the lowest bit first.
std::uint16_t mcrf4xx(const std::string& text) {
  unsigned crc = 0xFFFF;
  for (const char character : text) {
    crc ^= static_cast<unsigned char>(character);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? (crc >> 1) ^ 0x8408U : crc >> 1;
  }
  return static_cast<std::uint16_t>(crc);
}

struct Field {
  std::string type, name;
  std::size_t size() const {
    if (type == "float") return 4;
    return type.find("64") != std::string::npos   ? 8
           : type.find("32") != std::string::npos ? 4
           : type.find("16") != std::string::npos ? 2
                                                  : 1;
  }
};

std::vector<Field> all_of_type(const std::string& type, const std::vector<std::string>& names) {
  std::vector<Field> fields;
  for (const std::string& name : names) fields.push_back({type, name});
  return fields;
}

std::vector<Field> together(std::vector<Field> fields, const std::vector<Field>& more) {
  fields.insert(fields.end(), more.begin(), more.end());
  return fields;
}

/// As message_definitions/v1.0/common.xml has it, extensions left out.
struct Definition {
  std::string name;
  std::vector<Field> fields;

  /// The order of the wire: by size, and by the definition among equals.
  std::vector<Field> in_order() const {
    std::vector<Field> sorted = fields;
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const Field& a, const Field& b) { return a.size() > b.size(); });
    return sorted;
  }
  std::uint8_t crc_extra() const {
    std::string text = name + " ";
    for (const Field& field : in_order()) text += field.type + " " + field.name + " ";
    const std::uint16_t crc = mcrf4xx(text);
    return static_cast<std::uint8_t>((crc & 0xFFU) ^ (crc >> 8));
  }
  std::size_t payload() const {
    return std::accumulate(fields.begin(), fields.end(), std::size_t{0},
                           [](std::size_t bytes, const Field& field) { return bytes + field.size(); });
  }
  std::size_t offset(const std::string& field_name) const {
    std::size_t at = 0;
    for (const Field& field : in_order()) {
      if (field.name == field_name) return at;
      at += field.size();
    }
    ADD_FAILURE() << name << " has no " << field_name;
    return at;
  }
};

const std::vector<std::string> nine_axes{"xacc",  "yacc", "zacc", "xgyro", "ygyro",
                                         "zgyro", "xmag", "ymag", "zmag"};
const Definition scaled_imu{"SCALED_IMU",
                            together({{"uint32_t", "time_boot_ms"}}, all_of_type("int16_t", nine_axes))};
const Definition raw_imu{"RAW_IMU", together({{"uint64_t", "time_usec"}}, all_of_type("int16_t", nine_axes))};
const Definition highres_imu{
    "HIGHRES_IMU",
    together(together(together({{"uint64_t", "time_usec"}}, all_of_type("float", nine_axes)),
                      all_of_type("float", {"abs_pressure", "diff_pressure", "pressure_alt", "temperature"})),
             {{"uint16_t", "fields_updated"}})};
const Definition heartbeat{"HEARTBEAT",
                           {{"uint8_t", "type"},
                            {"uint8_t", "autopilot"},
                            {"uint8_t", "base_mode"},
                            {"uint32_t", "custom_mode"},
                            {"uint8_t", "system_status"},
                            {"uint8_t", "mavlink_version"}}};

/// A packet of version 2 from system 1.
ByteVector packet_v2(const mavlink::Message& message, const ByteVector& payload) {
  ByteVector packet{mavlink::sync_v2,
                    static_cast<std::uint8_t>(payload.size()),
                    0,
                    0,
                    0,
                    1,
                    1,
                    static_cast<std::uint8_t>(message.id),
                    0,
                    0};
  append(packet, payload);
  const std::string checked =
      std::string(packet.begin() + 1, packet.end()) + static_cast<char>(message.crc_extra);
  const std::uint16_t crc = mcrf4xx(checked);
  append(packet, ByteVector{static_cast<std::uint8_t>(crc & 0xFFU), static_cast<std::uint8_t>(crc >> 8)});
  return packet;
}

TEST(MavlinkMessages, HaveTheChecksumOfTheirCatalogue) {
  EXPECT_EQ(mcrf4xx("123456789"), 0x6F91);
}

TEST(MavlinkMessages, HaveTheCrcExtraAndTheSizeOfTheirDefinitions) {
  const std::vector<std::pair<mavlink::Message, Definition>> messages{{mavlink::scaled_imu, scaled_imu},
                                                                      {mavlink::raw_imu, raw_imu},
                                                                      {mavlink::highres_imu, highres_imu},
                                                                      {mavlink::heartbeat, heartbeat}};
  for (const auto& [message, definition] : messages) {
    EXPECT_EQ(message.crc_extra, definition.crc_extra()) << definition.name;
    EXPECT_EQ(message.payload_min, definition.payload()) << definition.name;
  }
}

TEST(MavlinkMessages, HaveTheirFieldsWhereTheDefinitionsPutThem) {
  EXPECT_EQ(mavlink::heartbeat_autopilot, heartbeat.offset("autopilot"));
  EXPECT_EQ(mavlink::scaled_imu_time_ms, scaled_imu.offset("time_boot_ms"));
  EXPECT_EQ(mavlink::scaled_imu_gyro, scaled_imu.offset("xgyro"));
  EXPECT_EQ(mavlink::raw_imu_time_us, raw_imu.offset("time_usec"));
  EXPECT_EQ(mavlink::raw_imu_gyro, raw_imu.offset("xgyro"));
  EXPECT_EQ(mavlink::highres_imu_time_us, highres_imu.offset("time_usec"));
  EXPECT_EQ(mavlink::highres_imu_gyro, highres_imu.offset("xgyro"));
  EXPECT_EQ(mavlink::highres_imu_temperature, highres_imu.offset("temperature"));
  EXPECT_EQ(mavlink::highres_imu_updated, highres_imu.offset("fields_updated"));
  // Extensions follow in the order of their definition.
  EXPECT_EQ(mavlink::scaled_imu_temperature, scaled_imu.payload());
  EXPECT_EQ(mavlink::raw_imu_id, raw_imu.payload());
  EXPECT_EQ(mavlink::raw_imu_temperature, raw_imu.payload() + 1);
  EXPECT_EQ(mavlink::highres_imu_id, highres_imu.payload());
}

sensors::GyroScanner mavlink_scanner(const std::map<std::string, double>& settings = {}) {
  return sensors::gyro_scanner({.protocol = "mavlink", .settings = settings});
}

Scan<GyroMessage> scan_mavlink(ByteSpan bytes, Stream stream = Stream::ends) {
  return scan_any_chunking<GyroMessage>(mavlink_scanner(), bytes, stream);
}

ByteVector vector_named(const std::string& name) {
  for (const GoldenVector& vector : read_vectors("mavlink_gyro.txt"))
    if (vector.name == name) return vector.bytes;
  throw std::runtime_error("no vector " + name);
}

ByteVector operator+(ByteVector left, const ByteVector& right) {
  left.insert(left.end(), right.begin(), right.end());
  return left;
}

TEST(MavlinkScanner, RefusesAPacketWithAnyFlippedBit) {
  for (const char* name : {"scaled_imu", "scaled_imu_version_1", "highres_imu"}) {
    const ByteVector packet = vector_named(name);
    for (std::size_t bit = 0; bit < 8 * packet.size(); ++bit) {
      ByteVector flipped = packet;
      flipped[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
      EXPECT_TRUE(scan_mavlink(flipped).messages.empty()) << name << ", bit " << bit;
    }
  }
}

TEST(MavlinkScanner, LosesOnlyThePacketWithAFlippedBit) {
  const ByteVector good = vector_named("scaled_imu");
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    ByteVector flipped = good;
    flipped[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    // What pretends to be longer swallows nothing: the packets behind it come out when their bytes are there.
    ByteVector stream = good + flipped;
    for (int i = 0; i < 10; ++i) stream = stream + good;
    const auto scan = scan_mavlink(stream);
    EXPECT_EQ(scan.messages.size(), 11U) << "bit " << bit;
    ASSERT_GE(scan.messages.size(), 2U);
    EXPECT_TRUE(scan.messages[1].lost_before) << "bit " << bit;
  }
}

TEST(MavlinkScanner, ResyncsAfterGarbage) {
  const ByteVector packet = vector_named("scaled_imu");
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    ByteVector stream = packet + random_bytes(700, seed);
    for (int i = 0; i < 20; ++i) stream = stream + packet;
    EXPECT_GE(scan_mavlink(stream).messages.size(), 13U) << seed;  // the longest false packet hides eight
  }
}

TEST(MavlinkScanner, FindsNoSampleInNoise) {
  const auto scan = scan_mavlink(random_bytes(500'000, 3), Stream::goes_on);
  EXPECT_TRUE(scan.messages.empty());
  EXPECT_LT(scan.counters.bytes_pending, 281U);
}

/// A router that lets the gyro's messages pass and no others, or a cable that lost some of these.
TEST(MavlinkScanner, TakesNumbersOfPacketsThatNeverCameForNoLostSamples) {
  const auto scan = scan_mavlink(vector_named("other_packets_filtered_out"));
  ASSERT_EQ(scan.messages.size(), 2U);
  EXPECT_EQ(scan.counters.lost, 0U);
  EXPECT_FALSE(scan.messages[1].lost_before);
}

TEST(MavlinkScanner, MarksTheSampleBehindAPacketThatItDidNotUnderstand) {
  const auto scan = scan_mavlink(vector_named("flag_not_understood"));
  ASSERT_EQ(scan.messages.size(), 2U);
  EXPECT_TRUE(scan.messages[1].lost_before);
}

TEST(MavlinkScanner, SpansTheSignatureToo) {
  const ByteVector bytes = vector_named("scaled_imu_signed");
  const auto scan = scan_mavlink(bytes);
  ASSERT_EQ(scan.messages.size(), 2U);
  EXPECT_EQ(scan.messages[0].span.end, bytes.size() / 2);
  EXPECT_EQ(scan.messages[1].span.end, bytes.size());
}

TEST(MavlinkScanner, DeliversASampleWithItsLastByte) {
  const ByteVector packet = vector_named("scaled_imu");
  sensors::GyroScanner scanner = mavlink_scanner();
  std::vector<GyroMessage> messages;
  scanner.push(ByteSpan(packet).first(packet.size() - 1), messages);
  EXPECT_TRUE(messages.empty());
  scanner.push(ByteSpan(packet).last(1), messages);
  EXPECT_EQ(messages.size(), 1U);
}

TEST(MavlinkScanner, ReadsNoRawCountsWithoutTheirScale) {
  const ByteVector raw = vector_named("raw_imu_scale_stated");
  EXPECT_TRUE(scan_mavlink(raw).messages.empty());
  const auto scan = scan_any_chunking<GyroMessage>(mavlink_scanner({{"raw_scale_dps", 0.0625}}), raw);
  ASSERT_EQ(scan.messages.size(), 1U);
  EXPECT_EQ(scan.messages[0].reading.rate_dps[0], 131 * 0.0625F);
}

/// SCALED_IMU in a packet of version 1 or 2, without the last bytes of its payload.
ByteVector cut_scaled_imu(bool is_v1, std::size_t cut) {
  const ByteVector whole = vector_named(is_v1 ? "scaled_imu_version_1" : "scaled_imu");
  const std::size_t header = is_v1 ? 6 : 10;
  std::string checked(whole.begin() + 1, whole.begin() + static_cast<std::ptrdiff_t>(header + 22 - cut));
  checked[0] = static_cast<char>(22 - cut);
  const std::uint16_t crc = mcrf4xx(checked + static_cast<char>(mavlink::scaled_imu.crc_extra));
  ByteVector packet{whole[0]};
  packet.insert(packet.end(), checked.begin(), checked.end());
  packet.push_back(static_cast<std::uint8_t>(crc & 0xFFU));
  packet.push_back(static_cast<std::uint8_t>(crc >> 8));
  return packet;
}

TEST(MavlinkScanner, TakesAShortPayloadForZerosInVersion2AndForBadInVersion1) {
  for (const std::size_t cut : {std::size_t{0}, std::size_t{1}, std::size_t{8}, std::size_t{20}}) {
    EXPECT_EQ(scan_mavlink(cut_scaled_imu(false, cut)).messages.size(), 1U) << cut;
    const auto scan = scan_mavlink(cut_scaled_imu(true, cut));
    EXPECT_EQ(scan.messages.size(), cut == 0 ? 1U : 0U) << cut;
    EXPECT_EQ(scan.counters.bad_length, cut == 0 ? 0U : 1U) << cut;
  }
}

TEST(MavlinkEvidence, NamesAControllerThatSendsNoGyro) {
  const ByteVector heartbeat_only = [] {
    const ByteVector three = vector_named("heartbeat_between");
    const std::size_t imu = vector_named("scaled_imu").size();
    return ByteVector(three.begin() + static_cast<std::ptrdiff_t>(imu),
                      three.end() - static_cast<std::ptrdiff_t>(imu));
  }();
  const auto evidence =
      sensors::gyro_protocol("mavlink").recognise(heartbeat_only + heartbeat_only + heartbeat_only, 3.0);
  ASSERT_TRUE(evidence.has_value());
  EXPECT_EQ(evidence->messages, 0U);
  EXPECT_EQ(evidence->text, "no IMU message among 3 good MAVLink packets");
  EXPECT_THAT(evidence->advice, HasSubstr("HIGHRES_IMU or SCALED_IMU"));
}

TEST(MavlinkEvidence, KnowsTheUnitOfRawCountsByTheControllersKind) {
  const ByteVector raw = vector_named("raw_imu_scale_stated");
  const auto of_kind = [&](std::uint8_t autopilot) {
    const ByteVector payload{0, 0, 0, 0, 2, autopilot, 81, 3, 3};
    const ByteVector kind = packet_v2(mavlink::heartbeat, payload);
    return sensors::gyro_protocol("mavlink").recognise(raw + kind + raw, 3.0);
  };
  const auto ardupilot = of_kind(mavlink::autopilot_ardupilot);
  ASSERT_TRUE(ardupilot.has_value());
  EXPECT_EQ(ardupilot->messages, 2U) << "those before the heartbeat, too";
  EXPECT_EQ(ardupilot->advice, "");
  EXPECT_EQ(ardupilot->settings.at("message"), 27);
  EXPECT_NEAR(ardupilot->settings.at("raw_scale_dps"), 0.0573, 1e-4);
  const auto other = of_kind(12);
  ASSERT_TRUE(other.has_value());
  EXPECT_THAT(other->text, HasSubstr("RAW_IMU"));
  EXPECT_THAT(other->advice, HasSubstr("raw_scale_dps"));
}

TEST(MavlinkScanner, ReadsTheLogOfAGroundStationWithoutALoss) {
  const ByteVector sample = vector_named("scaled_imu");
  const ByteVector unknown = packet_v2({30, 39, 28, 28}, ByteVector(28, 7));
  ByteVector log;
  for (std::uint8_t i = 0; i < 20; ++i) {
    append(log, ByteVector{0x00, 0x06, 0x0A, 0x24, 0x18, 0x1E, i, 0xFD});
    append(log, i % 3 == 1 ? unknown : sample);
  }
  const auto scan = scan_any_chunking<GyroMessage>(mavlink_scanner(), log, Stream::ends);
  EXPECT_EQ(scan.messages.size(), 13U);
  EXPECT_EQ(scan.counters.replies, 7U);
  EXPECT_EQ(scan.counters.resyncs, 0U);
  EXPECT_EQ(scan.counters.bytes_skipped, 8 * 20U);
  for (const GyroMessage& message : scan.messages) EXPECT_FALSE(message.lost_before);
}

}  // namespace
}  // namespace thermorig::test
