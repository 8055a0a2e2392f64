// SPDX-License-Identifier: MIT
#include "thermorig/sensors/device_stream.h"
#include "support/telemetry_bytes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "thermorig/sensors/servo_protocol.h"
#include "thermorig/sensors/wire/device_bytes.h"

namespace thermorig::sensors {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(DeviceStream, OfTheDefaultRigIsWhatItsProtocolsSay) {
  const RigProfile profile;
  const DeviceStream camera = device_stream(Device::camera, profile);
  EXPECT_EQ(camera.protocol, "gy-mcu90640");
  EXPECT_EQ(camera.message_bytes, 1544U);
  EXPECT_EQ(camera.rate_hz, 8.0);
  EXPECT_FALSE(camera.clock.sends_time());
  const DeviceStream gyro = device_stream(Device::gyro, profile);
  EXPECT_EQ(gyro.protocol, "witmotion");
  EXPECT_EQ(gyro.message_bytes, 11U);
  EXPECT_FALSE(gyro.clock.sends_time());
  const DeviceStream servo = device_stream(Device::servo, profile);
  EXPECT_EQ(servo.message_bytes, test::telemetry_bytes(1, {}).size());
  EXPECT_EQ(servo.rate_hz, 100.0);
  EXPECT_EQ(servo.clock.tick_s, 1e-6);
  EXPECT_EQ(servo.clock.wrap_ticks, std::uint64_t{1} << 32U);
}

TEST(DeviceStream, OfAGyroKnowsItsClockByTheProfile) {
  RigProfile profile;
  profile.gyro.protocol = "text";
  EXPECT_FALSE(device_stream(Device::gyro, profile).clock.sends_time());
  profile.gyro.text.time = 0;
  profile.gyro.text.time_unit_s = 1e-6;
  EXPECT_EQ(device_stream(Device::gyro, profile).clock.tick_s, 1e-6);
  profile.gyro.protocol = "mavlink";
  EXPECT_EQ(device_stream(Device::gyro, profile).clock.tick_s, 1e-3);
  profile.gyro.settings = {{"message", 105.0}};
  EXPECT_EQ(device_stream(Device::gyro, profile).clock.tick_s, 1e-6);
  EXPECT_EQ(device_stream(Device::gyro, profile).clock.wrap_ticks, 0U);
}

TEST(SearchSteps, GoOverEveryUsualBaudRateAndGreetServosLast) {
  std::vector<std::uint32_t> bauds;
  const std::vector<SearchStep> steps = search_steps();
  for (const SearchStep& step : steps) bauds.push_back(step.at.baud);
  EXPECT_THAT(bauds, ElementsAre(460800, 115200, 9600, 1000000, 921600, 230400, 38400, 57600, 250000, 1000000,
                                 2000000, 115200, 1000000, 115200));
  const std::vector<std::uint8_t> nothing;
  const std::vector<std::uint8_t> ask_for_frames{0xA5, 0x35, 0x02, 0xDC};
  const std::vector<std::uint8_t> ask_the_stick = camera_protocol("i2c-stick").greeting();
  const std::vector<std::uint8_t> ask_for_words = camera_protocol("mlx-raw").greeting();
  const std::vector<std::uint8_t> hello = wire::hello_bytes(0);
  const std::vector<std::uint8_t> ping = servo_protocol("dynamixel").greeting();
  const std::vector<std::uint8_t> status = servo_protocol("grbl").greeting();
  const std::vector<std::uint8_t> feetech = servo_protocol("sts3215").greeting();
  const std::vector greetings{ask_for_frames, ask_for_frames, ask_for_frames, ask_the_stick, ask_for_words,
                              nothing,        nothing,        ping,           hello,         ping,
                              ping,           status,         feetech,        feetech};
  for (std::size_t i = 0; i < steps.size(); ++i) {
    SCOPED_TRACE(steps[i].at.baud);
    EXPECT_EQ(steps[i].greeting, greetings[i]);
    EXPECT_EQ(steps[i].only_if_silent, greetings[i] != nothing && greetings[i] != hello);
  }
}

TEST(Recognise, SaysOfEveryRoleWhatSpeaksForIt) {
  EXPECT_THAT(recognise({}, 0.0), IsEmpty());
  const auto found = recognise(wire::camera_frame({}), 0.0);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].role, Device::camera);
  EXPECT_EQ(found[0].protocol, "gy-mcu90640");
  EXPECT_EQ(found[0].evidence.bytes, 1544U);
  std::vector<std::uint8_t> telemetry = test::telemetry_bytes(1, {});
  EXPECT_THAT(recognise(telemetry, 0.0), IsEmpty()) << "one message may be chance";
  const auto more = test::telemetry_bytes(2, {});
  telemetry.insert(telemetry.end(), more.begin(), more.end());
  ASSERT_EQ(recognise(telemetry, 0.0).size(), 1U);
  EXPECT_EQ(recognise(telemetry, 0.0)[0].role, Device::servo);
}

}  // namespace
}  // namespace thermorig::sensors
