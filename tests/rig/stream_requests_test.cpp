// SPDX-License-Identifier: MIT
#include "rig/recording/stream_requests.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "simulated_bus.h"
#include "thermorig/rig/recording/finalise.h"
#include "thermorig/sensors/device_stream.h"
#include "thermorig/sensors/gyro_sketch.h"

namespace thermorig::rig::test {
namespace {

using ::testing::IsEmpty;

HostTime at_s(double seconds) {
  return HostTime(from_s(seconds));
}

RigProfile with_flight_controller() {
  RigProfile profile = simulation::default_profile();
  profile.gyro.protocol = "mavlink";
  return profile;
}

/// What the profile's gyro is asked when it was asked so often in vain.
std::vector<std::uint8_t> asked(const RigProfile& profile, unsigned times) {
  return sensors::stream_request(Device::gyro, profile, times).at(0);
}

using Bytes = std::vector<std::uint8_t>;
const Bytes eight_hertz{0xA5, 0x25, 0x04, 0xCE}, automatic{0xA5, 0x35, 0x02, 0xDC};

TEST(StreamRequests, AskWhenThePortHasOpenedAndEachSecondWithoutAMessage) {
  const RigProfile profile = with_flight_controller();
  StreamRequests requests(profile);
  EXPECT_EQ(requests.due(Device::gyro, 0, at_s(0.0)), asked(profile, 0));
  EXPECT_THAT(requests.due(Device::gyro, 0, at_s(0.9)), IsEmpty());
  EXPECT_EQ(requests.due(Device::gyro, 0, at_s(1.0)), asked(profile, 1));
  EXPECT_THAT(requests.due(Device::gyro, 0, at_s(1.5)), IsEmpty());
  EXPECT_EQ(requests.due(Device::gyro, 0, at_s(2.0)), asked(profile, 2));
  EXPECT_THAT(requests.due(Device::gyro, 7, at_s(2.9)), IsEmpty());
  EXPECT_THAT(requests.due(Device::gyro, 7, at_s(3.8)), IsEmpty());
  EXPECT_EQ(requests.due(Device::gyro, 7, at_s(3.9)), asked(profile, 0)) << "it went silent later";
  requests.port_opened(Device::gyro);
  EXPECT_EQ(requests.due(Device::gyro, 7, at_s(4.0)), asked(profile, 0));
}

TEST(StreamRequests, AskACameraThatSendsNoStreamForOneMoreWithEachThatCame) {
  RigProfile profile = simulation::default_profile();
  profile.camera.protocol = "i2c-stick";
  StreamRequests requests(profile);
  const sensors::Commands commands = sensors::stream_request(Device::camera, profile, 0);
  double now_s = 0.0;
  for (const auto& command : commands) {
    EXPECT_EQ(requests.due(Device::camera, 0, at_s(now_s)), command);
    now_s += to_s(sensors::command_gap);
  }
  const std::vector<std::uint8_t> once = sensors::next_request(Device::camera, profile);
  EXPECT_EQ(requests.due(Device::camera, 1, at_s(now_s)), once);
  EXPECT_THAT(requests.due(Device::camera, 1, at_s(now_s)), IsEmpty());
  EXPECT_EQ(requests.due(Device::camera, 3, at_s(now_s)).size(), 2 * once.size());
  EXPECT_THAT(requests.due(Device::camera, 3, at_s(now_s), 5), IsEmpty()) << "refused, and no message";
  EXPECT_EQ(requests.due(Device::camera, 4, at_s(now_s), 5).size(), 6 * once.size());
}

TEST(StreamRequests, SayNothingToDevicesThatSendByThemselves) {
  RigProfile profile = simulation::default_profile();
  profile.gyro.protocol = "text";
  StreamRequests requests(profile);
  for (const Device device : {Device::gyro, Device::servo})
    for (const double seconds : {0.0, 1.0, 2.0, 60.0})
      EXPECT_THAT(requests.due(device, 0, at_s(seconds)), IsEmpty());
}

simulation::VirtualRigConfig rig_with_flight_controller(simulation::GyroStart start) {
  simulation::VirtualRigConfig config = simulation::default_rig(1, "kitchen");
  config.profile = with_flight_controller();
  config.gyro_start = start;
  return config;
}

DrivenRun record(SimulatedBus& bus, const RigProfile& profile) {
  const TemporaryFolder folder;
  return run_to_journal(bus, recording_options(folder, profile, short_plan()));
}

TEST(ARecording, MakesAFlightControllerSendItsSamples) {
  const auto config = rig_with_flight_controller(simulation::GyroStart::when_asked);
  SimulatedBus bus(config);
  const DrivenRun run = record(bus, config.profile);
  EXPECT_FALSE(run.failure) << run.failure->what_happened();
  EXPECT_EQ(run.raw.sent[Device::gyro].bytes, asked(config.profile, 0));
  const session::Session session = build_session(run.raw);
  EXPECT_GT(session.gyro.size(), 1000U);
  EXPECT_EQ(session.counters[Device::gyro].bytes_skipped, 0U);
  EXPECT_TRUE(session.gyro.front().reading.device_time_us.has_value());
}

TEST(ARecording, AsksAFlightControllerOfOldTheOldWay) {
  const auto config = rig_with_flight_controller(simulation::GyroStart::when_asked_of_old);
  SimulatedBus bus(config);
  const DrivenRun run = record(bus, config.profile);
  EXPECT_FALSE(run.failure) << run.failure->what_happened();
  const RawStream& sent = run.raw.sent[Device::gyro];
  ASSERT_EQ(sent.chunk_count(), 2U);
  EXPECT_TRUE(std::ranges::equal(sent.chunk(0), asked(config.profile, 0)));
  EXPECT_TRUE(std::ranges::equal(sent.chunk(1), asked(config.profile, 1)));
  EXPECT_NEAR(to_s(sent.time(1) - sent.time(0)), 1.0, 0.01);
  EXPECT_GT(build_session(run.raw).gyro.size(), 1000U);
}

TEST(ARecording, MakesAVectornavSendTheRatesThatItsFilterLeavesAlone) {
  auto config = simulation::default_rig(1, "kitchen");
  sensors::choose_gyro("vectornav", config.profile.gyro);
  config.gyro_start = simulation::GyroStart::when_asked;  // till then it sends VNYMR
  SimulatedBus bus(config);
  const DrivenRun run = record(bus, config.profile);
  EXPECT_FALSE(run.failure) << run.failure->what_happened();
  EXPECT_EQ(run.raw.sent[Device::gyro].bytes, asked(config.profile, 0));
  EXPECT_GT(build_session(run.raw).gyro.size(), 200U);
}

TEST(ARecording, AsksAFlightControllerAnewThatCameBack) {
  auto config = rig_with_flight_controller(simulation::GyroStart::by_itself);
  SimulatedBus bus(config);
  bus.unplugged = {{Device::gyro, at_s(6.0), at_s(8.0)}};
  const TemporaryFolder folder;
  RecordingOptions options = recording_options(folder, config.profile, short_plan());
  options.replug_patience_s = 20.0;
  VirtualOptions virtual_options{.recording = options};
  const RecordingResult result = record_virtual(bus, virtual_options);
  const RawRecording raw = session::read_raw(result.session);
  const RawStream& sent = raw.sent[Device::gyro];
  ASSERT_EQ(sent.chunk_count(), 2U);
  EXPECT_LT(to_s(sent.time(0) - HostTime{}), 0.1);
  EXPECT_NEAR(to_s(sent.time(1) - HostTime{}), 8.0, 0.1);
}

/// One of the steps that such a device has: it answers, and nothing in the profile is needed.
TEST(ARecording, AsksAWitmotionGyroOnceWhatItsFilterIs) {
  auto config = simulation::default_rig(1, "kitchen");
  config.world.gyro.bandwidth_hz = 20.0;
  config.profile.gyro.bandwidth_hz = 0.0;
  SimulatedBus bus(config);
  const DrivenRun run = record(bus, config.profile);
  EXPECT_FALSE(run.failure) << run.failure->what_happened();
  const std::vector<std::uint8_t> read_register_1f{0xFF, 0xAA, 0x27, 0x1F, 0x00};
  EXPECT_EQ(run.raw.sent[Device::gyro].bytes, read_register_1f);
  const session::Session session = build_session(run.raw);
  EXPECT_EQ(session.counters[Device::gyro].replies, 1U);
  EXPECT_EQ(session.sync.gyro.filter_source, "device");
  EXPECT_NEAR(session.sync.gyro.filter_delay_s.value, 0.225 / 20.0, 1e-9);
}

TEST(ARecording, SendsNothingToAGyroThatHearsNothing) {
  auto config = simulation::default_rig(1, "kitchen");
  config.profile.gyro.protocol = "text";
  SimulatedBus bus(config);
  const DrivenRun run = record(bus, config.profile);
  EXPECT_FALSE(run.failure);
  EXPECT_THAT(run.raw.sent[Device::gyro].bytes, IsEmpty());
}

TEST(StreamRequests, AskACameraForItsRateAndForFramesATenthOfASecondApart) {
  StreamRequests requests(simulation::default_profile());
  EXPECT_EQ(requests.due(Device::camera, 0, at_s(0.0)), eight_hertz);
  EXPECT_THAT(requests.due(Device::camera, 0, at_s(0.09)), IsEmpty());
  EXPECT_EQ(requests.due(Device::camera, 1, at_s(0.1)), automatic) << "a frame came meanwhile";
  EXPECT_THAT(requests.due(Device::camera, 1, at_s(0.99)), IsEmpty());
  EXPECT_THAT(requests.due(Device::camera, 9, at_s(1.9)), IsEmpty());
  EXPECT_EQ(requests.due(Device::camera, 9, at_s(2.9)), eight_hertz) << "it went silent";
  EXPECT_EQ(requests.due(Device::camera, 9, at_s(3.0)), automatic);
}

TEST(StreamRequests, GiveASlowCameraTheTimeOfThreeFrames) {
  RigProfile profile = simulation::default_profile();
  profile.camera.output_rate_hz = 0.5;
  StreamRequests requests(profile);
  EXPECT_EQ(requests.due(Device::camera, 0, at_s(0.0)), (Bytes{0xA5, 0x25, 0x00, 0xCA}));
  EXPECT_EQ(requests.due(Device::camera, 0, at_s(0.1)), automatic);
  EXPECT_THAT(requests.due(Device::camera, 0, at_s(5.9)), IsEmpty());
  EXPECT_FALSE(requests.due(Device::camera, 0, at_s(6.1)).empty());
}

TEST(StreamRequests, NameNoRateThatTheCameraDoesNotKnow) {
  const struct {
    double rate_hz;
    std::size_t commands;
  } rates[] = {{8.0, 2}, {7.84, 2}, {3.92, 2}, {1.0, 2}, {3.0, 1}, {16.0, 1}, {6.0, 1}};
  for (const auto& rate : rates) {
    RigProfile profile;
    profile.camera.output_rate_hz = rate.rate_hz;
    EXPECT_EQ(sensors::stream_request(Device::camera, profile, 0).size(), rate.commands) << rate.rate_hz;
  }
}

TEST(ARecording, MakesACameraSendThatWaitsToBeAskedAndAtTheRateOfTheProfile) {
  auto config = simulation::default_rig(1, "kitchen");
  const RigProfile profile = config.profile;
  config.camera_start = simulation::CameraStart::when_asked;
  config.profile.camera.output_rate_hz = 4.0;
  SimulatedBus bus(config);
  const DrivenRun run = record(bus, profile);
  EXPECT_FALSE(run.failure) << run.failure->what_happened();
  Bytes sent = eight_hertz;
  sent.insert(sent.end(), automatic.begin(), automatic.end());
  EXPECT_EQ(run.raw.sent[Device::camera].bytes, sent);
  const session::Session session = build_session(run.raw);
  EXPECT_NEAR(session.sync.clock[Device::camera].rate_hz, 7.84, 0.1);
}

TEST(ARecording, TakesTheFramesOfACameraThatHearsNothing) {
  auto config = simulation::default_rig(1, "kitchen");
  config.camera_start = simulation::CameraStart::deaf;
  SimulatedBus bus(config);
  EXPECT_FALSE(record(bus, config.profile).failure);
}

}  // namespace
}  // namespace thermorig::rig::test
