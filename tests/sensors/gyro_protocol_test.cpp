// SPDX-License-Identifier: MIT
#include "thermorig/sensors/gyro_protocol.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "simulation/gyro.h"
#include "thermorig/core/error.h"

namespace thermorig::sensors {
namespace {

using ::testing::ElementsAreArray;
using ::testing::HasSubstr;

/// Two seconds of what the simulated gyro sends of a protocol.
std::vector<std::uint8_t> simulated_bytes(const GyroProfile& profile) {
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < 400; ++i) {
    simulation::SimulatedGyroSample sample;
    sample.rate_dps = {1.5, -20.0, 0.1 * i};
    sample.index = static_cast<std::uint64_t>(i);
    sample.device_time_us = 5000 * i;
    const auto message = simulation::gyro_encoder(profile).bytes(sample, profile);
    bytes.insert(bytes.end(), message.begin(), message.end());
  }
  return bytes;
}

TEST(GyroProtocols, AreThoseThatTheSimulatedRigSpeaks) {
  std::vector<std::string> spoken;
  for (const simulation::GyroEncoder& encoder : simulation::gyro_encoders())
    spoken.emplace_back(encoder.name);
  EXPECT_THAT(gyro_protocol_names(), ElementsAreArray(spoken));
  const std::set<std::string> different(spoken.begin(), spoken.end());
  EXPECT_EQ(different.size(), spoken.size());
}

TEST(GyroProtocols, BeginWithTheOneOfAProfileThatNamesNone) {
  EXPECT_EQ(gyro_protocols().front().name, GyroProfile().protocol);
}

TEST(GyroProtocols, ReadWhatTheSimulatedRigSends) {
  for (const GyroProtocol& protocol : gyro_protocols()) {
    SCOPED_TRACE(protocol.name);
    const GyroProfile profile{.protocol = std::string(protocol.name)};
    GyroScanner scanner = gyro_scanner(profile, StreamStart::at_line_start);
    std::vector<wire::GyroMessage> messages;
    scanner.push(simulated_bytes(profile), messages);
    scanner.finish(messages);
    ASSERT_EQ(messages.size(), 400U);
    EXPECT_NEAR(messages[0].reading.rate_dps[0], 1.5, 0.04);
    EXPECT_NEAR(messages[0].reading.rate_dps[1], -20.0, 0.04);
    EXPECT_NEAR(messages[399].reading.rate_dps[2], 39.9, 0.04);
    for (const wire::GyroMessage& message : messages) {
      EXPECT_FALSE(message.lost_before);
      EXPECT_LE(message.span.size(), protocol.message_bytes(profile));
    }
  }
}

TEST(GyroProtocols, AreRecognisedByTheirOwnBytesAlone) {
  for (const GyroProtocol& sender : gyro_protocols()) {
    const auto bytes = simulated_bytes(GyroProfile{.protocol = std::string(sender.name)});
    for (const GyroProtocol& protocol : gyro_protocols()) {
      SCOPED_TRACE(std::string(sender.name) + " as " + std::string(protocol.name));
      const auto evidence = protocol.recognise(std::span(bytes).subspan(3), 2.0);
      ASSERT_EQ(evidence.has_value(), protocol.name == sender.name);
      if (!evidence) continue;
      EXPECT_GE(evidence->messages, 398U);
      EXPECT_GT(evidence->bytes, bytes.size() * 9 / 10);
    }
  }
}

TEST(GyroProtocols, RefuseANameThatIsNotAmongThemAndNameTheNearest) {
  EXPECT_EQ(find_gyro_protocol("witmoton"), nullptr);
  try {
    gyro_scanner({.protocol = "witmoton"});
    FAIL() << "nothing was refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_usage);
    EXPECT_THAT(error.what_happened(), HasSubstr("\"witmoton\" is not known"));
    EXPECT_THAT(error.advice(), HasSubstr("did you mean \"witmotion\"?"));
    for (const std::string& name : gyro_protocol_names()) EXPECT_THAT(error.advice(), HasSubstr(name));
  }
}

}  // namespace
}  // namespace thermorig::sensors
