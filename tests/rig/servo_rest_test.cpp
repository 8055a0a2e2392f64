// SPDX-License-Identifier: MIT
// Cables pulled, a disk that is full, a computer that stands still, a noisy line, in virtual time: the servo
// comes to rest within its limits, and nothing that came is lost.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <random>

#include "journal/failing_disk.h"
#include "servo_limits.h"
#include "struck_leg.h"
#include "thermorig/sensors/wire/servo_messages.h"
#include "thermorig/simulation/simulated_ports/simulated_ports.h"

namespace thermorig::rig::test {
namespace {

using ::testing::HasSubstr;

constexpr double until_rest_s = 0.3;

class ServoRest : public ::testing::Test, protected StruckLeg {
 protected:
  ServoRest() : StruckLeg(simulation::default_rig(3, "garden")) {}

  void expect_rest_from(HostTime begin, HostTime end) {
    EXPECT_GT(fastest_dps(begin - from_s(1.0), begin), moving_dps);
    EXPECT_LT(fastest_dps(begin + from_s(until_rest_s), end), rest_dps);
    expect_within_limits(ports_.rig().pulses(), options_.recording.profile.servo);
  }

  void expect_rest_to_the_end() {
    ASSERT_TRUE(struck_);
    expect_rest_from(*struck_, ports_.now());
  }

  /// What the program was given is in the session.
  void expect_complete(const RecordingResult& result) {
    const RawRecording raw = session::read_raw(result.session);
    for (const Device device : all_devices)
      EXPECT_TRUE(raw.received[device].bytes == ports_.delivered(device)) << name_of(device);
  }
};

class EachCable : public ServoRest, public ::testing::WithParamInterface<Device> {};
INSTANTIATE_TEST_SUITE_P(Devices, EachCable, ::testing::ValuesIn(all_devices),
                         [](const auto& device) { return std::string(name_of(device.param)); });

TEST_P(EachCable, ThatIsPulledEndsTheRecordingAtRestWithAllThatCame) {
  const RecordingResult result = suffer([this] { ports_.unplug(GetParam()); });
  EXPECT_EQ(result.exit, ExitCode::device_lost) << result.message;
  EXPECT_THAT(result.advice, HasSubstr("check cable and power"));
  expect_rest_to_the_end();
  expect_complete(result);
}

class EachSpareCable : public EachCable {};
INSTANTIATE_TEST_SUITE_P(Devices, EachSpareCable, ::testing::Values(Device::camera, Device::gyro),
                         [](const auto& device) { return std::string(name_of(device.param)); });

TEST_P(EachSpareCable, ThatIsPulledIsDoneWithout) {
  options_.recording.needed[GetParam()] = false;
  const RecordingResult result = suffer([this] { ports_.unplug(GetParam()); });
  EXPECT_EQ(result.exit, ExitCode::finished_lossy) << result.message;
  EXPECT_THAT(result.message, HasSubstr("without the " + std::string(name_of(GetParam()))));
  EXPECT_LT(fastest_dps(ports_.now() - from_s(1.0), ports_.now()), rest_dps);
  expect_complete(result);
}

TEST_F(ServoRest, FollowsADiskThatTakesNoMore) {
  journal::FailingDisk disk;
  options_.recording.disk = &disk;
  const RecordingResult result = suffer([&disk] { disk.errors["append"] = ENOSPC; });
  EXPECT_EQ(result.exit, ExitCode::storage);
  const auto stop = wire::stop_bytes();
  const auto& written = ports_.written(Device::servo);
  ASSERT_GE(written.size(), stop.size());
  EXPECT_TRUE(std::equal(stop.rbegin(), stop.rend(), written.rbegin()));
  expect_rest_to_the_end();
}

TEST_F(ServoRest, FollowsByItsWatchdogAComputerThatStandsStillAndTheLegIsDrivenAgain) {
  constexpr auto a_second = std::chrono::seconds(1);
  const RecordingResult result = suffer([&] { ports_.stand_still(a_second); });
  EXPECT_EQ(result.state, session::State::complete) << result.message;
  EXPECT_THAT(result.message, HasSubstr("the servo's watchdog tripped"));
  expect_rest_from(*struck_, *struck_ + a_second);
  const RawRecording raw = session::read_raw(result.session);
  ASSERT_EQ(raw.legs.size(), 3U);
  EXPECT_FALSE(raw.legs[0].complete);
  EXPECT_EQ(raw.legs[1].step, raw.legs[0].step);
  EXPECT_TRUE(raw.legs[1].complete);
  expect_complete(result);
}

class EachNoise : public ::testing::TestWithParam<std::uint32_t> {};
INSTANTIATE_TEST_SUITE_P(Seeds, EachNoise, ::testing::Range(1U, 11U));

/// A hundredth of the bytes from and to the servo have a bit turned, from the first leg on. The firmware is
/// the AVR image where that is built.
TEST_P(EachNoise, OnTheServosLineNeverLeadsBeyondItsLimits) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(GetParam(), "garden"), make_firmware(FirmwareChoice::avr_image));
  bus.rig.keep_truth(true);
  std::size_t flips = 0;
  const auto noise = [&flips, random = std::mt19937(GetParam())](std::vector<std::uint8_t> bytes,
                                                                 HostTime now) mutable {
    if (now < HostTime(from_s(3.0))) return bytes;
    for (std::uint8_t& byte : bytes)
      if (std::uniform_real_distribution<>()(random) < 0.01) {
        byte = static_cast<std::uint8_t>(byte ^ (1U << (random() % 8U)));
        ++flips;
      }
    return bytes;
  };
  bus.to_servo = noise;
  bus.from_device[index_of(Device::servo)] = noise;
  VirtualOptions options;
  options.recording = recording_options(folder, simulation::default_profile(), short_plan());
  record_virtual(bus, options);
  EXPECT_GT(flips, 10U);
  expect_within_limits(bus.rig.pulses(), options.recording.profile.servo);
}

}  // namespace
}  // namespace thermorig::rig::test
