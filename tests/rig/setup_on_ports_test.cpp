// SPDX-License-Identifier: MIT
// The guided first run by the built program, on pseudo terminals and by the clock: at night.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <future>

#include "acceptance/served_rig.h"
#include "app/program.h"
#include "support/file_text.h"
#include "thermorig/rig/profile/profile_file.h"
#include "thermorig/rig/setup/setup.h"
#include "thermorig/simulation/simulated_ports/simulated_ports.h"

namespace thermorig::rig::test {
namespace setup_on_ports {

using ::testing::HasSubstr;

class SetupOnPorts : public tests::ProgramTest {
 protected:
  void SetUp() override {
    if (std::getenv("THERMORIG_EVERYTHING") == nullptr) GTEST_SKIP() << "long: tests/nightly.sh runs it";
  }

  static int times(const std::string& text, const std::string& part) {
    int found = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
  }

  /// `thermorig setup PORT...` on a terminal, at which a person does what is asked and presses Enter.
  tests::Outcome set_up_by_hand(const std::string& ports, const std::function<void(std::string)>& person) {
    const auto keyboard = folder() / "keyboard";
    mkfifo(keyboard.c_str(), 0600);
    const int keys = open(keyboard.c_str(), O_RDWR | O_CLOEXEC);
    auto outcome = std::async(std::launch::async, [&] {
      return run_on_terminal("<keyboard NO_COLOR=1", "setup --save ./rig.toml " + ports);
    });
    while (outcome.wait_for(std::chrono::milliseconds(50)) != std::future_status::ready) {
      const std::string said = tests::file_text(folder() / "out.txt");
      if (times(said, "n: no]") + times(said, "press Enter") <= pressed_) continue;
      person(said);
      ++pressed_;
      EXPECT_EQ(::write(keys, "\n", 1), 1);
    }
    close(keys);
    return outcome.get();
  }

  static std::string paths_of(const SimulatedPorts& ports) {
    std::string paths;
    for (const Device device : all_devices) paths += " " + ports.paths()[device];
    return paths;
  }

  void expect_good(const tests::Outcome& outcome) const {
    EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("verdict  good"));
    EXPECT_THAT(outcome.out, HasSubstr("the rig is ready"));
    EXPECT_LT(pressed_, 10);
  }

  int pressed_ = 0;
};

TEST_F(SetupOnPorts, GoesFromNothingToAGoodSession) {
  SimulatedPorts ports(simulation::default_rig(4, "kitchen"), FirmwareChoice::avr_image);
  ports.start();
  expect_good(set_up_by_hand(paths_of(ports), [](const std::string&) {}));
}

/// The gyro prints rad/s, is upside down and has its axes swapped; the servo has half the travel.
TEST_F(SetupOnPorts, GoesToAGoodSessionOnARigThatIsNothingLikeTheStandardOne) {
  simulation::VirtualRigConfig config = simulation::default_rig(2, "kitchen");
  config.profile.gyro.protocol = "text";
  config.profile.gyro.text.scale_dps = 57.29577951308232;
  config.profile.gyro.axis = 0;
  config.profile.gyro.sign = -1;
  config.profile.servo.travel_deg = 1080.0;
  SimulatedPorts ports(config, FirmwareChoice::avr_image);
  ports.start();
  expect_good(set_up_by_hand(paths_of(ports), [](const std::string&) {}));
  const RigProfile profile = read_profile(folder() / "rig.toml");
  EXPECT_EQ(profile.gyro.axis, 0);
  EXPECT_EQ(profile.gyro.sign, -1);
  EXPECT_EQ(profile.servo.travel_deg, 1080.0);
}

TEST_F(SetupOnPorts, GoesToAGoodSessionWhereTwoPortsLookAlike) {
  SimulatedPorts ports(simulation::default_rig(4, "kitchen"), FirmwareChoice::avr_image);
  SimulatedPorts others(simulation::default_rig(5, "kitchen"), FirmwareChoice::host_build);
  ports.start();
  others.start();
  bool was_asked = false;
  expect_good(
      set_up_by_hand(paths_of(ports) + " " + others.paths()[Device::gyro], [&](const std::string& said) {
        if (was_asked || said.find("Unplug each gyro") == std::string::npos) return;
        was_asked = true;
        const std::string gone = others.paths()[Device::gyro];
        others.unplug(Device::gyro);
        while (std::filesystem::exists(gone)) usleep(10'000);
      }));
  EXPECT_TRUE(was_asked);
}

class InterruptedOnPorts : public SetupOnPorts, public ::testing::WithParamInterface<SetupStep> {};

INSTANTIATE_TEST_SUITE_P(At, InterruptedOnPorts,
                         ::testing::Values(SetupStep::ports, SetupStep::look, SetupStep::servo,
                                           SetupStep::turns, SetupStep::session),
                         [](const auto& test) {
                           return std::string(setup_step_names[static_cast<std::size_t>(test.param)]);
                         });

TEST_P(InterruptedOnPorts, LeavesTheServoAtRestAndTheOldProfile) {
  tests::ServedRig rig(1, "kitchen");
  rig.write_profile(folder() / "rig.toml");
  const std::string old = tests::file_text(folder() / "rig.toml");
  const std::string step(setup_step_names[static_cast<std::size_t>(GetParam())]);
  std::vector<std::string> words{"setup", "--yes", "--from", step, "--save", "./rig.toml"};
  for (const Device device : all_devices) words.push_back(rig.ports().paths()[device]);
  const pid_t setup = start(words);
  const bool moves = GetParam() >= SetupStep::servo;
  for (int i = 0; i < 1200; ++i) {
    const bool is_begun =
        tests::file_text(folder() / "background_out.txt").find(": " + step + "\n") != std::string::npos;
    if (moves ? rig.line().turned_us > 0 : is_begun) break;
    rig.let_pass(50'000);
  }
  rig.let_pass(moves ? 300'000 : 1'500'000);
  const std::int64_t struck_us = rig.line().now_us;
  kill(setup, SIGINT);
  const tests::Outcome outcome = wait(setup);
  rig.let_pass(1'000'000);
  const std::int64_t end_us = rig.line().now_us;
  rig.ports().stop();
  EXPECT_EQ(outcome.code, 130) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out + outcome.err, HasSubstr("stopped"));
  EXPECT_EQ(rig.fastest_dps(0, struck_us) > 5.0, moves);
  EXPECT_LT(rig.fastest_dps(struck_us + 700'000, end_us), 1.0);
  EXPECT_EQ(tests::file_text(folder() / "rig.toml"), old);
}

}  // namespace setup_on_ports
}  // namespace thermorig::rig::test
