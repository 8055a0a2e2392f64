// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <thread>

#include "program.h"
#include "thermorig/io/port.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;

class Ports : public ProgramTest {
 protected:
  /// `thermorig simulate` in the background; what it said first.
  nlohmann::json simulate() {
    process_ = start({"simulate", "--seed=3", "--world", "honest", "--json", "--profile", "simulated.toml"});
    std::string line;
    while (line.empty()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      std::ifstream file(folder() / "background_out.txt");
      std::getline(file, line);
      if (file.eof()) line.clear();  // not yet a whole line
    }
    return nlohmann::json::parse(line);
  }
  Outcome end_simulation() {
    kill(process_, SIGINT);
    return wait(process_);
  }

  static std::string port(const nlohmann::json& rig, const char* role) { return rig[role]; }

 private:
  pid_t process_ = -1;
};

TEST_F(Ports, FindsTheThreeRolesOfASimulatedRigInAnyOrder) {
  const auto rig = simulate();
  const Outcome outcome = run("ports --json --save found.toml " + port(rig, "servo") + " " +
                              port(rig, "camera") + " " + port(rig, "gyro"));
  const Outcome simulation = end_simulation();
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto found = outcome.lines()[0];
  ASSERT_EQ(found["ports"].size(), 3U);
  EXPECT_TRUE(found["missing"].empty());
  for (const auto& one : found["ports"]) EXPECT_EQ(one["port"], rig[one["role"].get<std::string>()]) << one;
  EXPECT_TRUE(std::filesystem::exists(folder() / "found.toml"));
  EXPECT_EQ(simulation.code, 0);
  EXPECT_EQ(simulation.lines().back()["event"], "summary");
}

TEST_F(Ports, ShowWhatOneDeviceSends) {
  const auto rig = simulate();
  const Outcome camera = run("look --json --seconds 1.5 " + port(rig, "camera"));
  const Outcome gyro = run("look --json --seconds 1 " + port(rig, "gyro"));
  const Outcome servo = run("look --seconds 1 " + port(rig, "servo"));
  end_simulation();
  ASSERT_EQ(camera.code, 0) << camera.err;
  EXPECT_EQ(camera.lines().back()["device"], "camera");
  EXPECT_GT(camera.lines().back()["rate_hz"].get<double>(), 4.0);
  EXPECT_LT(camera.lines().back()["low_c"].get<double>(), camera.lines().back()["high_c"].get<double>());
  ASSERT_EQ(gyro.code, 0) << gyro.err;
  EXPECT_EQ(gyro.lines().back()["rate_dps"].size(), 3U);
  ASSERT_EQ(servo.code, 0) << servo.err;
  EXPECT_THAT(servo.out, HasSubstr("firmware"));
  EXPECT_THAT(servo.out, HasSubstr("at rest"));
}

/// Nobody speaks there, and it is no serial port.
TEST_F(Ports, SayWhatToTryWhereNoDeviceCanBeLookedAt) {
  const Outcome outcome = run("look /dev/null");
  EXPECT_EQ(outcome.code, 4) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("try: "));
}

TEST_F(Ports, EndsWithAnErrorWhereRolesAreMissingAndSavesWhatThereIs) {
  const Outcome outcome = run("ports --save ./found.toml /dev/null");
  EXPECT_EQ(outcome.code, 4) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("missing  camera, gyro, servo"));
  EXPECT_THAT(outcome.out, HasSubstr("saved ./found.toml"));
  EXPECT_TRUE(std::filesystem::exists(folder() / "found.toml"));
}

TEST_F(Ports, RecordRefusesTheSamePortForTwoRoles) {
  std::filesystem::create_symlink("/dev/zero", folder() / "link");
  const Outcome outcome =
      run("record --environment garden --plan quick --camera /dev/null --gyro /dev/zero --servo ./link");
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("the same port is named for gyro and servo"));
}

TEST_F(Ports, TwoRecordersCannotShareAPort) {
  const auto rig = simulate();
  io::Loop other;
  other.open({.port = port(rig, "camera")},
             {.received = [](std::span<const std::uint8_t>, HostTime) {}, .lost = [](const std::string&) {}});
  const Outcome outcome = run("record --environment garden --plan quick --rig simulated.toml");
  end_simulation();
  EXPECT_EQ(outcome.code, 6) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr(port(rig, "camera")));
}

TEST_F(Ports, ADeviceThatIsPulledOutEndsTheRecordingAndWhatCameIsKept) {
  simulate();
  std::thread puller([this] {
    while (files(".journal").empty()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    std::this_thread::sleep_for(std::chrono::milliseconds(3500));
    end_simulation();
  });
  const Outcome outcome =
      run("record --environment garden --plan quick --replug-patience 1 --rig simulated.toml --json");
  puller.join();
  EXPECT_EQ(outcome.code, 5) << outcome.err << outcome.out;
  const auto summary = outcome.lines().back();
  EXPECT_EQ(summary["exit_code"], 5);
  EXPECT_GT(summary["frames"], 10);
  EXPECT_TRUE(std::filesystem::exists(folder() / summary["session"].get<std::string>()));
}

TEST_F(Ports, ASimulatedRigOnPortsIsRecordedAsAnyOther) {
  const Outcome outcome =
      run("record --world honest --simulated=3 --environment garden --json --plan quick --speeds 60 "
          "--frames-per-leg 8");
  ASSERT_EQ(outcome.code, 0) << outcome.err << outcome.out;
  const auto lines = outcome.lines();
  EXPECT_THAT(lines.front()["simulation"].get<std::string>(), HasSubstr("ports"));
  EXPECT_GE(lines.back()["frames_swept"], 16);
  EXPECT_TRUE(lines.back()["recorder_cpu_share"].is_number());
  EXPECT_GE(
      std::count_if(lines.begin(), lines.end(), [](const auto& line) { return line["event"] == "progress"; }),
      3);
}

}  // namespace
}  // namespace thermorig::tests
