// SPDX-License-Identifier: MIT
// Plugs pulled and put back while a plan is driven on ports behind links, as by-id names are.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "simulated_bus.h"
#include "thermorig/rig/recording/port_recording.h"
#include "thermorig/simulation/simulated_ports/simulated_ports.h"
#include "virtual_ports.h"

namespace thermorig::rig::test {
namespace {

using ::testing::HasSubstr;

SweepPlan two_legs() {
  PlanOverrides overrides;
  overrides.magnitudes_dps = {60.0};
  overrides.frames_per_leg = 8;
  overrides.valid_per_leg = 0;
  overrides.opening_rest_s = overrides.closing_rest_s = 0.2;
  return load_plan("quick", "kitchen", 1, overrides);
}

class Plugs : public ::testing::Test {
 protected:
  Plugs() {
    options_.recording = recording_options(folder_, simulation::default_profile(), two_legs());
    options_.recording.replug_patience_s = 30.0;
    for (const Device device : all_devices) {
      link(device, ports_.paths()[device]);
      options_.recording.profile.link(device).port = name(device);
    }
    options_.progress_period = std::chrono::milliseconds(50);
    options_.progress = [this](const RecordingProgress& progress) { watch(progress); };
  }

  static std::string name(Device device) { return "/dev/serial/by-id/" + std::string(name_of(device)); }
  void link(Device device, const std::string& path) { ports_.link(name(device), path); }

  void watch(const RecordingProgress& progress) {
    if (progress.sweep.phase == SweepPhase::leg && progress.sweep.frames >= 2 && !pulled_) {
      pulled_ = true;
      ports_.unplug(device_);
    }
    if (progress.gone[device_] && when_gone_) std::exchange(when_gone_, nullptr)();
    const auto& awaited = progress.awaited[device_];
    if (!awaited) return;
    was_awaited_ = true;
    if (when_awaited_ && awaited->waited_s > 0.7) std::exchange(when_awaited_, nullptr)();
  }

  void put_back() { link(device_, ports_.plug_in(device_)); }

  RecordingResult record() { return record_ports(options_, ports_); }

  TemporaryFolder folder_;
  VirtualPorts ports_{simulation::default_rig(1, "kitchen")};
  PortOptions options_;
  Device device_ = Device::camera;
  bool pulled_ = false;
  bool was_awaited_ = false;
  std::function<void()> when_gone_;
  std::function<void()> when_awaited_ = [this] { put_back(); };
};

class EachPlug : public Plugs, public ::testing::WithParamInterface<Device> {};
INSTANTIATE_TEST_SUITE_P(Devices, EachPlug, ::testing::ValuesIn(all_devices),
                         [](const auto& device) { return std::string(name_of(device.param)); });

TEST_P(EachPlug, ThatIsPutBackIsFoundByItsName) {
  device_ = GetParam();
  const RecordingResult result = record();
  EXPECT_TRUE(was_awaited_);
  EXPECT_EQ(result.state, session::State::complete) << result.message;
  EXPECT_THAT(result.message, HasSubstr("the " + std::string(name_of(device_)) + " was away for"));
  const session::Session session = session::read_session(result.session);
  EXPECT_EQ(session.sync.clock[device_].epochs.size(), 2U);
  EXPECT_EQ(std::count_if(session.raw.legs.begin(), session.raw.legs.end(),
                          [](const LegRecord& leg) { return !leg.complete; }),
            1);
}

TEST_F(Plugs, CtrlCWhileOneIsAwaitedEndsIt) {
  when_awaited_ = [] { std::raise(SIGINT); };
  const RecordingResult result = record();
  EXPECT_EQ(result.exit, ExitCode::interrupted) << result.message;
  EXPECT_TRUE(std::filesystem::exists(result.session));
  EXPECT_EQ(session::read_session(result.session).servo.back().state.motion, ServoMotion::disarmed);
}

TEST_F(Plugs, AGyroThatIsNotNeededIsTakenUpAgain) {
  device_ = Device::gyro;
  options_.recording.needed[Device::gyro] = false;
  options_.recording.plan.frames_per_leg = 16;
  when_gone_ = [this] { put_back(); };
  const RecordingResult result = record();
  EXPECT_EQ(result.exit, ExitCode::finished_lossy) << result.message;
  EXPECT_FALSE(was_awaited_);
  const session::Session session = session::read_session(result.session);
  EXPECT_TRUE(
      std::any_of(session.raw.events.begin(), session.raw.events.end(), [](const RecordingEvent& event) {
        return event.kind == EventKind::device_back && event.source == Device::gyro;
      }));
  EXPECT_EQ(session.sync.clock[Device::gyro].epochs.size(), 2U);
}

TEST_F(Plugs, AGyroThatComesLateIsTakenUpWhereItIsNotNeeded) {
  device_ = Device::gyro;
  pulled_ = true;
  ports_.remove_link(name(Device::gyro));
  options_.recording.needed[Device::gyro] = false;
  when_gone_ = [this] { link(Device::gyro, ports_.paths()[Device::gyro]); };
  const RecordingResult result = record();
  EXPECT_FALSE(session::read_session(result.session).gyro.empty());
}

TEST_F(Plugs, APseudoTerminalIsNotLookedForByItsNumber) {
  options_.recording.profile.camera.link.port = ports_.paths()[Device::camera];
  options_.recording.replug_patience_s = 2.0;
  when_awaited_ = [&] { ports_.plug_in(Device::camera); };
  const RecordingResult result = record();
  EXPECT_EQ(result.exit, ExitCode::device_lost);
  EXPECT_THAT(result.message, HasSubstr("did not come back within 2 s"));
}

TEST_F(Plugs, AProgramThatHoldsTheReturnedPortIsWaitedForAndThenNamed) {
  when_awaited_ = [&] {
    const std::string path = ports_.plug_in(Device::camera);
    ports_.hold(path);
    link(Device::camera, path);
  };
  const RecordingResult result = record();
  EXPECT_EQ(result.exit, ExitCode::no_permission);
  EXPECT_THAT(result.message, HasSubstr("it is back, but port is in use by another program"));
}

/// The same on the kernel's own: a camera whose pseudo terminal comes back under another number, behind a
/// link.
TEST(PlugOnAPseudoTerminal, ThatIsPutBackIsFoundByItsName) {
  const TemporaryFolder folder;
  SimulatedPorts ports(simulation::default_rig(1, "kitchen"), FirmwareChoice::host_build);
  ports.start();
  const auto name = folder.path() / "camera";
  const auto link = [&](const std::string& path) {
    std::filesystem::remove(name);
    std::filesystem::create_symlink(path, name);
  };
  PortOptions options;
  options.recording = recording_options(folder, simulation::default_profile(), two_legs());
  options.recording.virtual_time = false;
  options.recording.sync_period = std::chrono::milliseconds(125);
  options.recording.replug_patience_s = 30.0;
  for (const Device device : all_devices) options.recording.profile.link(device).port = ports.paths()[device];
  link(ports.paths()[Device::camera]);
  options.recording.profile.camera.link.port = name;
  bool is_pulled = false, is_back = false;
  options.progress_period = std::chrono::milliseconds(50);
  options.progress = [&](const RecordingProgress& progress) {
    if (!is_pulled && progress.sweep.phase == SweepPhase::leg && progress.sweep.frames >= 2) {
      is_pulled = true;
      ports.unplug(Device::camera);
    }
    if (!is_back && progress.awaited[Device::camera]) {
      is_back = true;
      link(ports.plug_in(Device::camera));
    }
  };
  const RecordingResult result = record_ports(options);
  EXPECT_TRUE(is_back);
  EXPECT_EQ(result.state, session::State::complete) << result.message;
  EXPECT_THAT(result.message, HasSubstr("the camera was away for"));
}

}  // namespace
}  // namespace thermorig::rig::test
