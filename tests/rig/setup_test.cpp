// SPDX-License-Identifier: MIT
// The guided first run, on a simulated rig's ports in virtual time.
#include "thermorig/rig/setup/setup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <csignal>
#include <functional>
#include <tuple>

#include "simulated_bus.h"
#include "thermorig/core/error.h"
#include "thermorig/rig/profile/profile_file.h"
#include "thermorig/rig/recording/port_recording.h"
#include "virtual_ports.h"

namespace thermorig::rig::test {
namespace setup {

using ::testing::EndsWith;
using ::testing::HasSubstr;

/// A person who does what is asked, and a computer in virtual time.
class VirtualWorld : public SetupWorld {
 public:
  explicit VirtualWorld(const simulation::VirtualRigConfig& config) : ports(config) {
    for (const Device device : all_devices) paths.push_back(ports.paths()[device]);
    ports.add([this] {
      if (strikes_at && ports.now() >= *strikes_at) strike();
      return std::vector<std::uint8_t>();
    });
  }

  std::vector<PortFinding> listen() override {
    std::vector<io::PortInfo> infos;
    for (const std::string& path : paths) infos.push_back({.path = path});
    return identify_devices(infos, ports);
  }
  void show(const RigProfile& profile) override {
    seen = see_devices({.environment = "kitchen", .profile = profile}, ports);
  }
  session::Session record(const RigProfile& profile, const SweepPlan& plan) override {
    PortOptions options{.recording = recording_options(folder, profile, plan)};
    options.progress_period = std::chrono::milliseconds(50);
    options.progress = [this](const RecordingProgress& progress) {
      if (step == struck_step && progress.sweep.phase == SweepPhase::leg && progress.sweep.frames >= 4)
        strike();
    };
    const RecordingResult result = record_ports(options, ports);
    if (result.exit != ExitCode::ok && result.exit != ExitCode::finished_lossy)
      throw Error(result.exit, result.message, "setup", result.advice);
    return session::read_session(result.session);
  }
  void begin(SetupStep begun) override {
    step = begun;
    constexpr auto at_work = std::chrono::milliseconds(2500);
    if (step == struck_step && step <= SetupStep::look) strikes_at = ports.now() + at_work;
  }
  void say(const std::string& text) override { said += text; }
  void confirm(const std::string& question) override {
    if (++confirmed == says_no_at) throw Error(ExitCode::interrupted, "answered with no", "", "");
    said += question;
  }
  void ask_to(const std::string& request) override {
    said += request;
    if (!does_as_asked) throw Error(ExitCode::device_missing, "nobody is there", "", "");
    does_as_asked();
  }
  bool flash(const std::string&) override { return false; }
  std::string firmware_image() const override { return "servo_firmware.hex"; }
  std::string command_again(std::optional<SetupStep> from) const override {
    return from ? fmt::format("again from {}", setup_step_names[static_cast<std::size_t>(*from)]) : "again";
  }

  TemporaryFolder folder;
  VirtualPorts ports;
  std::vector<std::string> paths;
  std::string said;
  int confirmed = 0, says_no_at = 0;
  std::function<void()> does_as_asked;
  DevicesSeen seen;
  SetupStep step{};
  std::optional<SetupStep> struck_step;  // once: in the midst of it, while the servo moves if it does
  std::function<void()> strikes;
  std::optional<HostTime> strikes_at;
  HostTime struck;

 private:
  void strike() {
    struck_step.reset();
    strikes_at.reset();
    struck = ports.now();
    strikes();
  }
};

std::optional<Error> error_of(const std::function<void()>& does) {
  try {
    does();
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

/// A gyro that prints three numbers in rad/s, upside down with swapped axes, and a servo of half the travel.
TEST(Setup, FindsOutAllAboutARigThatIsNothingLikeTheStandardOne) {
  simulation::VirtualRigConfig config = simulation::default_rig(2, "kitchen");
  config.profile.gyro.protocol = "text";
  config.profile.gyro.text.scale_dps = 57.29577951308232;
  config.profile.gyro.axis = 0;
  config.profile.gyro.sign = -1;
  config.profile.servo.travel_deg = 1080.0;
  config.profile.camera.mirrored = false;
  VirtualWorld world(config);
  const auto path = world.folder.path() / "rig.toml";
  const RigProfile profile = set_up(path, SetupStep::ports, world);
  EXPECT_EQ(profile.gyro.axis, 0);
  EXPECT_EQ(profile.gyro.sign, -1);
  EXPECT_NEAR(profile.gyro.text.scale_dps, 57.29577951308232, 1e-9);
  EXPECT_EQ(profile.servo.travel_deg, 1080.0);
  EXPECT_FALSE(profile.camera.mirrored);
  EXPECT_FALSE(profile.camera.link.latency_measured_utc.empty());
  EXPECT_LT(world.confirmed, 10);
  EXPECT_EQ(profile_text(read_profile(path)), profile_text(profile));
  EXPECT_THAT(world.said, HasSubstr("it sends rad/s"));
}

/// Small moves of a servo of 180 degrees are a twelfth of what a winch would make of them.
TEST(Setup, TellsAServoOf180DegreesFromAWinchByItsSmallMoves) {
  simulation::VirtualRigConfig config = simulation::default_rig(1, "kitchen");
  config.profile.servo.travel_deg = 180.0;
  VirtualWorld world(config);
  const SetupState state = set_up_servo(set_up_ports({}, world), world);
  EXPECT_NEAR(state.profile.servo.travel_deg, 180.0, 30.0);  // the turns tell it better
  EXPECT_EQ(state.profile.gyro.axis, config.profile.gyro.axis);
  EXPECT_EQ(world.confirmed, 2);
}

TEST(Setup, AsksToUnplugOneOfTwoPortsThatLookAlike) {
  VirtualWorld world(simulation::default_rig(1, "kitchen"));
  const std::string other = world.ports.add([] {
    std::vector<std::uint8_t> bytes;
    for (int i = 0; i < 4; ++i)
      for (const char byte : std::string("gx:0.1,gy:0.2,gz:0.3\r\n"))
        bytes.push_back(static_cast<std::uint8_t>(byte));
    return bytes;
  });
  world.paths.push_back(other);
  EXPECT_THAT(error_of([&] { set_up_ports({}, world); })->what_happened(), HasSubstr("nobody"));
  world.does_as_asked = [&] { world.paths.pop_back(); };
  const SetupState state = set_up_ports({}, world);
  EXPECT_EQ(state.profile.gyro.link.port, world.ports.paths()[Device::gyro]);
  EXPECT_THAT(world.said, HasSubstr("2 ports look like a gyro"));
  EXPECT_THAT(world.said, HasSubstr(other));
}

/// A board that nobody flashed says nothing.
TEST(Setup, SaysHowToFlashABoardThatDoesNotAnswer) {
  VirtualWorld world(simulation::default_rig(1, "kitchen"));
  const std::string servo = world.paths.back();
  world.paths.back() = world.ports.add([] { return std::vector<std::uint8_t>(); });
  const std::string silent = world.paths.back();
  world.does_as_asked = [&] { world.paths.back() = servo; };
  const SetupState state = set_up_ports({}, world);
  EXPECT_EQ(state.profile.servo.link.port, servo);
  EXPECT_THAT(world.said, HasSubstr("avrdude -p atmega328p -c arduino -P " + silent +
                                    " -b 115200 -U flash:w:servo_firmware.hex:i"));
  EXPECT_THAT(world.said, HasSubstr("-b 57600"));
}

TEST(Setup, LeavesNoProfileOrTheOldOneWhereverItIsInterrupted) {
  for (const bool is_old : {false, true})
    for (const int question : {1, 2, 3}) {
      SCOPED_TRACE(question);
      VirtualWorld world(simulation::default_rig(1, "kitchen"));
      const auto path = world.folder.path() / "rig.toml";
      RigProfile old;
      old.name = "old";
      if (is_old) write_profile(path, old);
      world.says_no_at = question;
      const auto error = error_of([&] { set_up(path, SetupStep::ports, world); });
      ASSERT_TRUE(error);
      EXPECT_EQ(error->code(), ExitCode::interrupted);
      ASSERT_EQ(std::filesystem::exists(path), is_old);
      if (!is_old) continue;
      EXPECT_EQ(profile_text(read_profile(path)), profile_text(old));
    }
}

/// As SIGKILL: nothing of the program runs behind it.
struct Killed {};

struct Interruption {
  const char* name;
  void (*strikes)();
};

const Interruption interruptions[] = {{"CtrlC", [] { std::raise(SIGINT); }},
                                      {"Terminated", [] { std::raise(SIGTERM); }},
                                      {"HungUp", [] { std::raise(SIGHUP); }},
                                      {"Killed", [] { throw Killed(); }}};

struct Moment {
  const char* name;
  SetupStep step;
};

const Moment moments[] = {{"WhileItListens", SetupStep::ports},
                          {"WhileItShowsTheDevices", SetupStep::look},
                          {"WhileTheServoIsTried", SetupStep::servo},
                          {"WhileItTurns", SetupStep::turns},
                          {"WhileItRecordsItsSession", SetupStep::session}};

class InterruptedSetup : public ::testing::TestWithParam<std::tuple<Interruption, Moment>> {};

INSTANTIATE_TEST_SUITE_P(By, InterruptedSetup,
                         ::testing::Combine(::testing::ValuesIn(interruptions), ::testing::ValuesIn(moments)),
                         [](const auto& test) {
                           return std::string(std::get<0>(test.param).name) + std::get<1>(test.param).name;
                         });

TEST_P(InterruptedSetup, LeavesTheServoAtRestAndTheOldProfile) {
  const auto& [interruption, moment] = GetParam();
  const simulation::VirtualRigConfig config = simulation::default_rig(1, "kitchen");
  VirtualWorld world(config);
  const auto path = world.folder.path() / "rig.toml";
  RigProfile old = config.profile;
  old.name = "old";
  for (const Device device : all_devices) old.link(device).port = world.ports.paths()[device];
  write_profile(path, old);
  world.strikes = interruption.strikes;
  world.struck_step = moment.step;
  bool was_killed = false;
  try {
    const RigProfile profile = set_up(path, moment.step, world);
    world.begin(SetupStep::session);  // the last step is the caller's
    world.record(profile, load_plan("quick", "kitchen", 1, {}));
    FAIL() << "nothing ended it";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::interrupted);
  } catch (const Killed&) {
    was_killed = true;
  }
  EXPECT_EQ(was_killed, std::string_view(interruption.name) == "Killed");
  world.ports.let_pass(std::chrono::seconds(1));
  double before_dps = 0.0, after_dps = 0.0;
  for (const simulation::TruthSample& sample : world.ports.rig().shaft()) {
    double* const fastest = sample.time < world.struck                 ? &before_dps
                            : sample.time > world.struck + from_s(0.4) ? &after_dps
                                                                       : nullptr;
    if (fastest != nullptr) *fastest = std::max(*fastest, std::abs(sample.rate_dps));
  }
  EXPECT_EQ(before_dps > 5.0, moment.step >= SetupStep::servo) << before_dps;
  EXPECT_LT(after_dps, 1.0);
  EXPECT_EQ(profile_text(read_profile(path)), profile_text(old));
}

/// The servo's supply is off: it answers, and nothing turns.
TEST(Setup, SaysWhatToCheckWhereNothingMoves) {
  simulation::VirtualRigConfig config = simulation::default_rig(1, "kitchen");
  config.servo_loop_hz = 1e-6;
  VirtualWorld world(config);
  const auto path = world.folder.path() / "rig.toml";
  const auto error = error_of([&] { set_up(path, SetupStep::ports, world); });
  ASSERT_TRUE(error);
  EXPECT_THAT(error->what_happened(), HasSubstr("no axis of the gyro turns with the servo"));
  EXPECT_THAT(error->advice(), HasSubstr("supply"));
  EXPECT_THAT(error->advice(), EndsWith("; then again"));  // nothing is known yet to go on with
}

TEST(Setup, RefusesToGoOnWithAProfileThatIsNotThere) {
  VirtualWorld world(simulation::default_rig(1, "kitchen"));
  const auto error = error_of([&] { set_up(world.folder.path() / "rig.toml", SetupStep::turns, world); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ExitCode::bad_usage);
  EXPECT_THROW(setup_step_named("tunrs"), Error);
}

}  // namespace setup
}  // namespace thermorig::rig::test
