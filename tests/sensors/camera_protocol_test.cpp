// SPDX-License-Identifier: MIT
#include "thermorig/sensors/camera_protocol.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "simulation/camera.h"
#include "thermorig/core/error.h"

namespace thermorig::sensors {
namespace {

using ::testing::ElementsAreArray;
using ::testing::HasSubstr;

/// What the simulated camera answers when it is asked for its frames.
std::vector<std::uint8_t> simulated_answer(const CameraProfile& profile) {
  const CameraProtocol& protocol = camera_protocol(profile.protocol);
  const simulation::CameraEncoder& encoder = simulation::camera_encoder(profile);
  std::vector<std::uint8_t> answer;
  if (protocol.request == nullptr) return answer;
  for (const auto& command : protocol.request(profile)) {
    const auto part = encoder.hear(command, profile).answer;
    answer.insert(answer.end(), part.begin(), part.end());
  }
  return answer;
}

/// Five frames that it sends of a protocol, each warmer than the one before, their halves in turn the newest.
std::vector<std::uint8_t> simulated_bytes(const CameraProfile& profile) {
  std::vector<std::uint8_t> bytes;
  for (int i = 0; i < 5; ++i) {
    simulation::SimulatedFrame frame;
    frame.frame.temp_c.fill(20.0F + static_cast<float>(i));
    frame.frame.sensor_temp_c = 31.5F;
    frame.newest_half = static_cast<unsigned>(i) & 1U;
    const auto message = simulation::camera_encoder(profile).bytes(frame, profile);
    bytes.insert(bytes.end(), message.begin(), message.end());
  }
  return bytes;
}

TEST(CameraProtocols, AreThoseThatTheSimulatedRigSpeaks) {
  std::vector<std::string> spoken;
  for (const simulation::CameraEncoder& encoder : simulation::camera_encoders())
    spoken.emplace_back(encoder.name);
  EXPECT_THAT(camera_protocol_names(), ElementsAreArray(spoken));
}

TEST(CameraProtocols, BeginWithTheOneOfAProfileThatNamesNone) {
  EXPECT_EQ(camera_protocols().front().name, CameraProfile().protocol);
}

TEST(CameraProtocols, ReadWhatTheSimulatedRigSends) {
  for (const CameraProtocol& protocol : camera_protocols()) {
    SCOPED_TRACE(protocol.name);
    CameraProfile profile;
    profile.protocol = protocol.name;
    CameraScanner scanner = camera_scanner(profile);
    std::vector<wire::CameraMessage> messages;
    scanner.push(simulated_answer(profile), messages);
    scanner.push(simulated_bytes(profile), messages);
    scanner.finish(messages);
    const bool sends_halves =  // the first alone is no image
        protocol.name == "i2c-stick" || protocol.name == "mlx-raw";
    ASSERT_EQ(messages.size(), sends_halves ? 4U : 5U);
    const ThermalFrame& frame = messages[messages.size() - 2].frame;
    EXPECT_NEAR(frame.temp_c[100], 23.0F, sends_halves ? 0.08F : 0.01F);  // which are whole counts
    EXPECT_TRUE(std::isnan(frame.sensor_temp_c) || std::abs(frame.sensor_temp_c - 31.5F) < 0.01F);
    for (const wire::CameraMessage& message : messages) {
      EXPECT_FALSE(message.resync_before);
      EXPECT_EQ(message.fresh.both_fresh(), !sends_halves);
      EXPECT_FALSE(message.fresh.none_fresh());
      EXPECT_LE(message.span.size(), protocol.message_bytes);
    }
  }
}

TEST(CameraProtocols, AskCamerasThatListenAndNoOthers) {
  for (const CameraProtocol& protocol : camera_protocols()) {
    CameraProfile profile;
    profile.protocol = protocol.name;
    const simulation::CameraEncoder& encoder = simulation::camera_encoder(profile);
    ASSERT_EQ(protocol.request == nullptr, encoder.hear == nullptr);
    ASSERT_EQ(protocol.request == nullptr, protocol.greeting == nullptr);
    if (protocol.request == nullptr) continue;
    const bool is_asked_for_each = protocol.next != nullptr;
    for (const auto& command : {protocol.request(profile).back(), protocol.greeting()}) {
      const simulation::Heard heard = encoder.hear(command, profile);
      EXPECT_EQ(heard.asks_for_stream, !is_asked_for_each);
      EXPECT_EQ(heard.asked > 1, is_asked_for_each);
    }
    if (is_asked_for_each) {
      EXPECT_EQ(encoder.hear(protocol.next(profile), profile).asked, 1U);
    }
  }
}

TEST(CameraProtocols, AreRecognisedByTheirOwnBytesAlone) {
  for (const CameraProtocol& sender : camera_protocols()) {
    CameraProfile profile;
    profile.protocol = sender.name;
    const auto bytes = simulated_bytes(profile);
    for (const CameraProtocol& protocol : camera_protocols()) {
      SCOPED_TRACE(std::string(sender.name) + " as " + std::string(protocol.name));
      const auto evidence = protocol.recognise(std::span(bytes).subspan(3));
      ASSERT_EQ(evidence.has_value(), protocol.name == sender.name);
      // The first may be cut, the last may wait for the one behind it.
      EXPECT_GE(evidence ? evidence->messages : 3U, 3U);
    }
  }
}

TEST(CameraProtocols, AreLessSureOfTheirExposureWhereTheTableSaysSo) {
  const double of_a_bridge_s = latency_uncertainty_s(CameraProfile{});
  for (const CameraProtocol& protocol : camera_protocols()) {
    CameraProfile camera;
    camera.protocol = protocol.name;
    EXPECT_EQ(latency_uncertainty_s(camera) > of_a_bridge_s, protocol.merges_halves) << protocol.name;
    camera.link.latency_measured_utc = "2026-11-30T12:00:00Z";
    EXPECT_EQ(latency_uncertainty_s(camera), camera.link.latency_uncertainty_s) << protocol.name;
  }
}

TEST(CameraProtocols, RefuseANameThatIsNotAmongThemAndNameTheNearest) {
  CameraProfile profile;
  profile.protocol = "gy-mcu9064";
  try {
    camera_scanner(profile);
    FAIL() << "nothing was refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_usage);
    EXPECT_THAT(error.what_happened(), HasSubstr("the camera protocol \"gy-mcu9064\" is not known"));
    EXPECT_THAT(error.advice(), HasSubstr("gy-mcu90640"));
  }
}

}  // namespace
}  // namespace thermorig::sensors
