// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <fstream>
#include <functional>
#include <iterator>
#include <thread>

#include "program.h"
#include "thermorig/io/port.h"
#include "thermorig/simulation/gyro.h"
#include "thermorig/wire/device_bytes.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A pseudo terminal on which something speaks: `say` gives the bytes of each 20 ms.
class Speaker {
 public:
  explicit Speaker(std::function<std::vector<std::uint8_t>()> say)
      : thread_([this, say = std::move(say)] {
          while (!stop_) {
            port_.write(say());
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
          }
        }) {}
  ~Speaker() {
    stop_ = true;
    thread_.join();
  }
  Speaker(const Speaker&) = delete;
  Speaker& operator=(const Speaker&) = delete;
  std::string path() const { return port_.path(); }

 private:
  io::Pty port_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

std::vector<std::uint8_t> silence() {
  return {};
}

std::vector<std::uint8_t> gyro_words() {
  const auto packet = wire::witmotion_gyro_packet({1, 2, 3}, 30.0F);
  return {packet.begin(), packet.end()};
}

/// A gyro that prints its milliseconds and three rates; 50 lines a second.
std::function<std::vector<std::uint8_t>()> gyro_lines() {
  return [ms = 1000]() mutable {
    ms += 20;
    const std::string line = std::to_string(ms) + ",0.5,-1.25," + std::to_string(ms % 3) + "\r\n";
    return std::vector<std::uint8_t>(line.begin(), line.end());
  };
}

class Ports : public ProgramTest {
 protected:
  /// `thermorig simulate` in the background; what it said first.
  nlohmann::json simulate() {
    process_ = start({"simulate", "--seed=3", "--json", "--profile", "simulated.toml"});
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

TEST_F(Ports, SaysWhichRolesAreMissing) {
  const Speaker gyro(gyro_words);
  const Speaker nobody(silence);
  const Outcome outcome = run("ports " + nobody.path() + " " + gyro.path());
  EXPECT_EQ(outcome.code, 4);
  EXPECT_THAT(outcome.out, HasSubstr("missing  camera, servo"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("next  thermorig record")));
  EXPECT_THAT(outcome.out, HasSubstr("unknown"));
  EXPECT_LT(outcome.out.find("gyro "), outcome.out.find("unknown"));
}

TEST_F(Ports, AnAmbiguousRoleIsNotedAndNothingToRecordWithIsSuggested) {
  const Speaker one(gyro_words), other(gyro_words);
  const Outcome outcome = run("ports --save ./found.toml " + one.path() + " " + other.path());
  EXPECT_EQ(outcome.code, 4);
  EXPECT_THAT(outcome.out, HasSubstr("2 ports look like a gyro: "));
  EXPECT_THAT(outcome.out, HasSubstr("saved "));
  EXPECT_THAT(outcome.out, Not(HasSubstr("next  thermorig record")));
}

TEST_F(Ports, RecordRefusesTheSamePortForTwoRoles) {
  const Speaker camera(silence), gyro(silence);
  std::filesystem::create_symlink(gyro.path(), folder() / "link");
  const Outcome outcome = run("record --environment garden --plan quick --camera " + camera.path() +
                              " --gyro " + gyro.path() + " --servo ./link");
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("the same port is named for gyro and servo"));
}

TEST_F(Ports, SavesTheColumnsOfATextGyroAndAsksToCheckThem) {
  const Speaker gyro(gyro_lines());
  const Outcome outcome = run("ports --save text.toml " + gyro.path());
  EXPECT_THAT(outcome.out, HasSubstr(",0.5,-1.25,"));
  EXPECT_THAT(
      outcome.out,
      HasSubstr("taken: no prefix, columns 1,2,3 as x,y,z, 1 deg/s a unit, time in column 0 (0.001 s"));
  EXPECT_THAT(outcome.out, HasSubstr("check scale and columns"));
  std::ifstream file(folder() / "text.toml");
  const std::string profile(std::istreambuf_iterator<char>(file), {});
  EXPECT_THAT(profile, HasSubstr("x_column = 1"));
  EXPECT_THAT(profile, HasSubstr("z_column = 3"));
  EXPECT_THAT(profile, HasSubstr("time_column = 0"));

  const auto found = run("ports --json " + gyro.path()).lines()[0]["ports"][0];
  EXPECT_EQ(found["text_format"]["columns"], nlohmann::json({1, 2, 3}));
}

TEST_F(Ports, KnowsAFlightControllerAndSavesItsProtocol) {
  const Speaker gyro([sample = simulation::SimulatedGyroSample()]() mutable {
    ++sample.index;
    sample.device_time_us += 20'000;
    return simulation::gyro_bytes(sample, {.protocol = "mavlink", .output_rate_hz = 50.0});
  });
  const Outcome outcome = run("ports --save bench.toml " + gyro.path());
  EXPECT_THAT(outcome.out, HasSubstr("MAVLink packets"));
  std::ifstream file(folder() / "bench.toml");
  EXPECT_THAT(std::string(std::istreambuf_iterator<char>(file), {}), HasSubstr("protocol = \"mavlink\""));
  EXPECT_EQ(run("ports --json " + gyro.path()).lines()[0]["ports"][0]["gyro_protocol"], "mavlink");
}

TEST_F(Ports, RecordNamesThePortThatSendsNothing) {
  const Speaker camera(silence), gyro(gyro_words), servo(silence);
  const Outcome outcome = run("record --environment garden --plan quick --camera " + camera.path() +
                              " --gyro " + gyro.path() + " --servo " + servo.path());
  EXPECT_EQ(outcome.code, 4) << outcome.err;
  EXPECT_THAT(outcome.err, ::testing::AnyOf(HasSubstr(camera.path()), HasSubstr(servo.path())));
  EXPECT_THAT(outcome.err, HasSubstr("try: "));
  EXPECT_TRUE(files(".h5").empty());
}

TEST_F(Ports, RecordRecognisesAnotherDevicesBytes) {
  const auto rig = simulate();
  const Outcome outcome = run("record --environment garden --plan quick --camera " + port(rig, "gyro") +
                              " --gyro " + port(rig, "camera") + " --servo " + port(rig, "servo"));
  end_simulation();
  EXPECT_EQ(outcome.code, 4) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("gyro"));
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
      run("record --simulated=3 --environment garden --json --plan quick --speeds 60 --frames-per-leg 8");
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
