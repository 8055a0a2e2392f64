// SPDX-License-Identifier: MIT
// What VectorNav, Xsens, HiPNUC and MicroStrain gyros have in common: frames with a mark, a length and a sum.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <string_view>

#include "simulation/gyro.h"
#include "thermorig/sensors/device_stream.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "wire/scan.h"

namespace thermorig::test::framed_gyro {
namespace {

using testing::HasSubstr;

struct Device {
  const char* protocol;
  std::array<std::uint8_t, 3> mark;  // in front of a frame
};
constexpr std::array devices{Device{"vectornav", {'$', 'V', 'N'}}, Device{"xsens", {0xFA, 0xFF, 0x36}},
                             Device{"hipnuc", {0x5A, 0xA5, 0x4C}}, Device{"mip", {0x75, 0x65, 0x80}}};

GyroProfile profile_of(const char* protocol) {
  return {.protocol = protocol, .output_rate_hz = 100.0};
}

/// One sample: its rate about z tells it.
ByteVector frame(const char* protocol, int number) {
  simulation::SimulatedGyroSample sample;
  sample.index = static_cast<std::uint64_t>(number);
  sample.device_time_us = 10'000 * number;
  sample.rate_dps = {1.5, -20.0, static_cast<double>(number)};
  return simulation::gyro_encoder(profile_of(protocol)).bytes(sample, profile_of(protocol));
}

void append(ByteVector& bytes, ByteSpan more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

Scan<wire::GyroMessage> scan(const char* protocol, const ByteVector& bytes) {
  return scan_any_chunking<wire::GyroMessage>(sensors::gyro_scanner(profile_of(protocol)), bytes,
                                              Stream::ends);
}

/// Bytes by chance, with marks of frames among them.
ByteVector garbage(const Device& device, std::size_t size) {
  std::mt19937 random(5);
  ByteVector bytes;
  while (bytes.size() < size) {
    if (random() % 16 == 0) append(bytes, ByteSpan(device.mark).first(1 + random() % 3));
    bytes.push_back(static_cast<std::uint8_t>(random()));
  }
  return bytes;
}

TEST(AFramedGyro, IsReadBehindGarbageThatHoldsItsMarks) {
  for (const Device& device : devices) {
    SCOPED_TRACE(device.protocol);
    ByteVector bytes = garbage(device, 700);
    for (int number = 1; number <= 20; ++number) append(bytes, frame(device.protocol, number));
    const auto found = scan(device.protocol, bytes);
    ASSERT_EQ(found.messages.size(), 20U);
    EXPECT_TRUE(found.messages.front().lost_before);
    for (int number = 1; number <= 20; ++number)
      EXPECT_NEAR(found.messages[static_cast<std::size_t>(number - 1)].reading.rate_dps[2], number, 1e-3);
  }
}

/// Of three frames the second has one byte that is another: the others are read, and it is not read as
/// another sample.
TEST(AFramedGyro, LosesNoMoreThanTheFrameThatIsDamaged) {
  for (const Device& device : devices) {
    SCOPED_TRACE(device.protocol);
    const ByteVector damaged = frame(device.protocol, 2);
    for (std::size_t at = 0; at < damaged.size(); ++at)
      for (const unsigned flip : {0x01U, 0x20U, 0x80U, 0xFFU}) {
        ByteVector bytes = frame(device.protocol, 1);
        append(bytes, damaged);
        bytes[bytes.size() - damaged.size() + at] ^= static_cast<std::uint8_t>(flip);
        append(bytes, frame(device.protocol, 3));
        sensors::GyroScanner scanner = sensors::gyro_scanner(profile_of(device.protocol));
        std::vector<wire::GyroMessage> messages;
        scanner.push(bytes, messages);
        scanner.finish(messages);
        const std::string place = "byte " + std::to_string(at) + ", flipped " + std::to_string(flip);
        ASSERT_GE(messages.size(), 2U) << place;
        EXPECT_NEAR(messages.front().reading.rate_dps[2], 1.0, 1e-3) << place;
        EXPECT_NEAR(messages.back().reading.rate_dps[2], 3.0, 1e-3) << place;
        EXPECT_LE(messages.size(), 3U) << place;
        if (messages.size() == 3) {
          EXPECT_NEAR(messages[1].reading.rate_dps[2], 2.0, 1e-3) << place;
        }
      }
  }
}

TEST(AFramedGyro, HasTheTimeOfItsOwnClockWhereItSendsOne) {
  for (const Device& device : devices) {
    SCOPED_TRACE(device.protocol);
    const auto found = scan(device.protocol, frame(device.protocol, 7));
    ASSERT_EQ(found.messages.size(), 1U);
    const bool sends_time =
        sensors::gyro_protocol(device.protocol).clock(profile_of(device.protocol)).sends_time();
    EXPECT_EQ(found.messages[0].reading.device_time_us,
              sends_time ? std::optional<std::int64_t>(70'000) : std::nullopt);
  }
}

std::vector<sensors::Recognised> recognised(const ByteVector& bytes) {
  return sensors::recognise(bytes, 1.0);
}

ByteVector bytes_of(std::string_view text) {
  return {text.begin(), text.end()};
}

/// Nothing that could be recorded is made of them, and what to try is said.
void expect_advice(const ByteVector& frame, const std::string& what, const std::string& advice) {
  SCOPED_TRACE(what);
  ByteVector bytes;
  for (int i = 0; i < 5; ++i) append(bytes, frame);
  const auto found = recognised(bytes);
  ASSERT_FALSE(found.empty());
  for (const sensors::Recognised& one : found) EXPECT_FALSE(one.is_usable()) << one.evidence.text;
  EXPECT_THAT(found.front().evidence.text, HasSubstr(what));
  EXPECT_THAT(found.front().evidence.advice, HasSubstr(advice));
}

TEST(AFramedGyro, WithoutRatesIsToldWhatToSend) {
  expect_advice({0xFA, 0xFF, 0x36, 0x05, 0x10, 0x20, 0x02, 0x00, 0x07, 0x8D}, "no rates of turn among 5",
                "RateOfTurn");
  expect_advice({0x75, 0x65, 0x80, 0x04, 0x04, 0x99, 0x00, 0x01, 0xFC, 0x5B}, "no rates of turn among 5",
                "field 05");
  expect_advice(bytes_of("$VNQTN,+0.0,+0.0,+0.0,+1.0*52\r\n"), "no rates of turn among 5", "$VNWRG,06,19*54");
  expect_advice({0x5A, 0xA5, 0x02, 0x00, 0x07, 0x1A, 0x90, 0x01}, "tag 90", "packet 91");
}

TEST(Vectornav, OfAFiltersRatesIsReadWhereTheProfileSaysSo) {
  const ByteVector bytes = bytes_of(
      "$VNYMR,-044.862,-00.351,+001.210,+01.1829,-00.2437,+03.0010,-00.373,-00.102,-09.865,-00.010500,"
      "+00.002000,+00.349066*5C\r\n");
  ByteVector many;
  for (int i = 0; i < 5; ++i) append(many, bytes);
  const auto found = recognised(many);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].is_usable());
  EXPECT_TRUE(found[0].evidence.is_asked_otherwise);
  EXPECT_EQ(found[0].evidence.settings.at("filtered"), 1.0);
  EXPECT_THAT(found[0].evidence.text, HasSubstr("its filter has taken a bias off the rates"));
}

TEST(Vectornav, IsAskedForTheRatesThatItsFilterLeavesAlone) {
  RigProfile profile;
  profile.gyro.protocol = "vectornav";
  EXPECT_EQ(sensors::stream_request(thermorig::Device::gyro, profile, 0),
            sensors::Commands{bytes_of("$VNWRG,06,19*54\r\n")});
  profile.gyro.settings["filtered"] = 1.0;
  EXPECT_EQ(sensors::stream_request(thermorig::Device::gyro, profile, 3),
            sensors::Commands{bytes_of("$VNWRG,06,14*59\r\n")});
}

}  // namespace
}  // namespace thermorig::test::framed_gyro
