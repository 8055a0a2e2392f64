// SPDX-License-Identifier: MIT
#include "thermorig/rig/recording/port_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <memory>

#include "simulated_bus.h"
#include "thermorig/rig/recording/finalise.h"
#include "virtual_ports.h"

namespace thermorig::rig::test {
namespace {

using ::testing::HasSubstr;

/// A simulated rig on three ports, and a plan of five seconds.
class Ports : public ::testing::Test {
 protected:
  Ports() {
    options_.recording = recording_options(folder_, simulation::default_profile(), plan());
    for (const Device device : all_devices)
      options_.recording.profile.link(device).port = ports_.paths()[device];
    options_.progress_period = std::chrono::milliseconds(50);
  }

  static SweepPlan plan() {
    PlanOverrides overrides;
    overrides.magnitudes_dps = {60.0};
    overrides.frames_per_leg = 8;
    overrides.opening_rest_s = overrides.closing_rest_s = 0.2;
    return load_plan("quick", "kitchen", 1, overrides);
  }

  RecordingResult record() { return record_ports(options_, ports_); }

  std::optional<Error> error() {
    try {
      record();
    } catch (const Error& error) {
      return error;
    }
    return std::nullopt;
  }

  /// Runs `action` once, when the first leg has begun.
  void in_first_leg(std::function<void()> action) {
    options_.progress = [action, acted = std::make_shared<bool>(false)](const RecordingProgress& progress) {
      if (progress.sweep.phase != SweepPhase::leg || progress.sweep.frames < 2 || *acted) return;
      *acted = true;
      action();
    };
  }

  TemporaryFolder folder_;
  VirtualPorts ports_{simulation::default_rig(1, "kitchen")};
  PortOptions options_;
};

TEST_F(Ports, RecordAWholePlan) {
  const RecordingResult result = record();
  EXPECT_EQ(result.exit, ExitCode::ok) << result.message;
  EXPECT_EQ(result.state, session::State::complete);
  const session::Session session = session::read_session(result.session);
  ASSERT_EQ(session.raw.legs.size(), 2U);
  for (const LegRecord& leg : session.raw.legs) EXPECT_EQ(leg.frames, 8);
  const auto folder = std::filesystem::recursive_directory_iterator(folder_.path());
  EXPECT_TRUE(std::none_of(begin(folder), end(folder),
                           [](const auto& entry) { return entry.path().extension() == ".journal"; }));
}

class EachSignal : public Ports, public ::testing::WithParamInterface<int> {};
INSTANTIATE_TEST_SUITE_P(Signals, EachSignal, ::testing::Values(SIGINT, SIGTERM, SIGHUP),
                         [](const auto& signal) { return std::string("SIG") + sigabbrev_np(signal.param); });

TEST_P(EachSignal, StopsTheServoAndClosesTheFile) {
  in_first_leg([] { std::raise(GetParam()); });
  const RecordingResult result = record();
  EXPECT_EQ(result.exit, ExitCode::interrupted);
  EXPECT_EQ(result.state, session::State::partial);
  const session::Session session = session::read_session(result.session);
  EXPECT_EQ(session.servo.back().state.motion, ServoMotion::disarmed);
}

TEST_F(Ports, CtrlCTwiceStopsTheServoAndLeavesAJournalThatBecomesASession) {
  in_first_leg([] { std::raise(SIGINT); });
  std::string noticed;
  options_.notice = [&](const std::string& sentence) {
    noticed += sentence;
    std::raise(SIGINT);
  };
  const RecordingResult left = record();
  EXPECT_EQ(left.exit, ExitCode::interrupted);
  EXPECT_THAT(noticed, HasSubstr("stopping the servo"));
  EXPECT_TRUE(left.session.empty());
  EXPECT_EQ(left.advice, "thermorig recover " + left.journal.string());
  const auto recovered = recover(left.journal);
  ASSERT_EQ(recovered.size(), 1U);
  const session::Session session = session::read_session(recovered[0].session);
  EXPECT_EQ(session.state, session::State::partial);
  EXPECT_TRUE(session.raw.complete);  // closed by the recorder
  EXPECT_EQ(session.servo.back().state.motion, ServoMotion::disarmed);
  for (const Device device : all_devices)
    EXPECT_TRUE(session.raw.received[device].bytes == ports_.delivered(device)) << name_of(device);
}

TEST_F(Ports, AnUnpluggedCameraEndsTheRecordingProperly) {
  in_first_leg([this] { ports_.unplug(Device::camera); });
  const RecordingResult result = record();
  EXPECT_EQ(result.exit, ExitCode::device_lost);
  EXPECT_THAT(result.message, HasSubstr("camera"));
  EXPECT_EQ(session::read_session(result.session).servo.back().state.motion, ServoMotion::disarmed);
}

TEST_F(Ports, AnUnpluggedServoEndsTheRecordingProperly) {
  in_first_leg([this] { ports_.unplug(Device::servo); });
  const RecordingResult result = record();
  EXPECT_EQ(result.exit, ExitCode::device_lost);
  EXPECT_THAT(result.message, HasSubstr("servo"));
  EXPECT_TRUE(std::filesystem::exists(result.session));
}

TEST_F(Ports, AMissingPortLeavesNothingBehind) {
  options_.recording.profile.gyro.link.port = "/dev/ttyNoSuchPort";
  const auto refused = error();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code(), ExitCode::device_missing);
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(Ports, AMissingPortThatIsNotNeededKeepsItsOwnAdvice) {
  options_.recording.profile.gyro.link.port.clear();
  options_.recording.needed[Device::gyro] = false;
  const RecordingResult result = record();
  EXPECT_EQ(result.exit, ExitCode::finished_lossy);
  EXPECT_THAT(result.advice, HasSubstr("--gyro PORT"));
}

TEST_F(Ports, CameraAndGyroThatWereNeverThereAreMissingAndNotLost) {
  options_.recording.profile.gyro.link.port.clear();
  options_.recording.profile.camera.link.port = "/dev/ttyNoSuchPort";
  options_.recording.needed = {{false, false, true}};
  const auto refused = error();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code(), ExitCode::device_missing);
  EXPECT_THAT(refused->advice(), HasSubstr("--gyro PORT"));
}

TEST_F(Ports, SwappedPortsAreExplained) {
  std::swap(options_.recording.profile.camera.link.port, options_.recording.profile.gyro.link.port);
  options_.recording.start_patience_s = 1.5;
  const auto refused = error();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code(), ExitCode::device_missing);
  EXPECT_THAT(refused->what(), HasSubstr("this is the gyro, not the camera"));
}

TEST_F(Ports, TheOneThatSendsNothingIsNamed) {
  const std::string silent = ports_.add([] { return std::vector<std::uint8_t>(); });
  options_.recording.profile.camera.link.port = silent;
  const auto refused = error();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->code(), ExitCode::device_missing);
  EXPECT_THAT(refused->what(), HasSubstr("camera (" + silent + ")"));
  EXPECT_THAT(refused->advice(), HasSubstr("thermorig ports"));
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(Ports, TwoRecordersDoNotShareAPort) {
  std::optional<Error> second;
  in_first_leg([&] { second = error(); });
  const RecordingResult result = record();
  ASSERT_TRUE(second);
  EXPECT_EQ(second->code(), ExitCode::no_permission);
  EXPECT_EQ(result.state, session::State::complete);
}

}  // namespace
}  // namespace thermorig::rig::test
