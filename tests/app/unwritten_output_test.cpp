// SPDX-License-Identifier: MIT
// Standard output on a full disk, or read by nobody: each command does its work, and then says that its
// result was not written.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "program.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;

constexpr int output = 9;  // one digit: what every shell takes behind ">&"

class Unwritten : public ProgramTest {
 protected:
  ~Unwritten() override { close(output); }

  void give_full_disk() {
    const int full = open("/dev/full", O_WRONLY | O_CLOEXEC);
    ASSERT_GE(dup2(full, output), 0);
    close(full);
  }

  void give_pipe_without_reader() {
    std::array<int, 2> ends{};
    ASSERT_EQ(pipe2(ends.data(), O_CLOEXEC), 0);
    ASSERT_GE(dup2(ends[1], output), 0);
    close(ends[0]);
    close(ends[1]);
  }

  Outcome run_there(const std::string& arguments) const {
    return run(arguments + " 2>err.txt >&" + std::to_string(output) + " #");
  }

  void expect_told(const std::string& arguments) const {
    const Outcome outcome = run_there(arguments);
    EXPECT_EQ(outcome.code, 7) << arguments << "\n" << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("standard output")) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr("try: ")) << arguments;
  }

  void expect_told_by_each(const std::vector<std::string>& commands) const {
    for (const std::string& command : commands)
      for (const char* form : {"", " --json"}) expect_told(command + form);
  }

  const std::string record = "record --world honest --simulated=3 --fast --environment garden " + brief_plan;
};

TEST_F(Unwritten, ResultsOfARecordingAreExitCode7AndTheSessionIsNamed) {
  give_full_disk();
  for (const char* form : {"", " --json"}) {
    const std::size_t before = files(".h5").size();
    const Outcome outcome = run_there(record + form);
    EXPECT_EQ(outcome.code, 7) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("thermorig inspect recordings/garden/garden_acq-0"));
    EXPECT_EQ(files(".h5").size(), before + 1);
    EXPECT_TRUE(files(".journal").empty());
  }
  expect_told(record + " --dry-run");
}

TEST_F(Unwritten, ResultsOfACalibrationAreExitCode7AndTheProfileIsKept) {
  give_full_disk();
  for (const char* form : {"", " --json"}) {
    const Outcome outcome =
        run_there(std::string("calibrate bias --world honest --simulated=3 --fast --save kept.toml") + form);
    EXPECT_EQ(outcome.code, 7) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("the result is in kept.toml"));
    EXPECT_TRUE(std::filesystem::remove(folder() / "kept.toml"));
  }
}

TEST_F(Unwritten, ResultsAboutSessionsAreExitCode7) {
  const std::string session = record_briefly().string();
  give_full_disk();
  expect_told_by_each({"inspect " + session, "recover recordings", "reprocess " + session, "doctor",
                       "live --speed max --page-port 0 --replay " + session, "--version"});
  EXPECT_EQ(files(".h5").size(), 1U);
}

TEST_F(Unwritten, ResultsOfALearnerAreExitCode7AndItsFilesAreThere) {
  record_briefly();
  ASSERT_EQ(run("record --world honest --simulated=4 --fast --environment garden " + brief_plan).code, 0);
  give_full_disk();
  // More lines than a buffer holds: they must not end the training.
  expect_told("train recordings --nf 2 --nr 3 --epochs 60 -o text.onnx");
  expect_told("train recordings --nf 2 --nr 3 --epochs 2 --json -o json.onnx");
  EXPECT_TRUE(std::filesystem::exists(folder() / "text.onnx"));
  EXPECT_TRUE(std::filesystem::exists(folder() / "json.onnx"));
  expect_told_by_each({"evaluate text.onnx recordings"});
  expect_told("export text.onnx --batch 1 -o made");
  expect_told("export text.onnx --batch 2 -o made --json");
  EXPECT_EQ(files(".onnx").size(), 6U);  // each model, its run's, and two exports
}

// As `thermorig ... | head` ends.
TEST_F(Unwritten, APipeThatEndsIsNoErrorOfAnyCommandAndItsExitCodeIs7) {
  const std::string session = record_briefly().string();
  std::ofstream(folder() / "dump.txt") << "1,2,3\n1,2,3\n";
  give_pipe_without_reader();
  std::string many = "inspect";
  for (int i = 0; i < 20; ++i) many += " " + session;
  for (const std::string& command :
       {"inspect " + session, many, std::string("list recordings"),
        std::string("decode --device gyro --gyro-protocol text dump.txt"), "export --csv -o - " + session,
        "export --npz -o made " + session, "live --no-page --speed max --replay " + session,
        std::string("help record")})
    for (const char* form : {"", " --json"}) {
      if (command.starts_with("export --csv -o -") && *form != '\0') continue;  // takes nothing else
      std::filesystem::remove_all(folder() / "made");
      const Outcome outcome = run_there(command + form);
      EXPECT_EQ(outcome.code, 7) << command << form;
      EXPECT_EQ(outcome.err, "") << command << form;
    }
}

TEST_F(Unwritten, APipeThatEndsStopsNoRecordingAndWhatWasMadeIsNamed) {
  give_pipe_without_reader();
  for (const char* form : {"", " --json"}) {
    const Outcome outcome = run_there(record + form);
    EXPECT_EQ(outcome.code, 7);
    const auto session = files(".h5").back().lexically_relative(folder());
    EXPECT_EQ(outcome.err, "thermorig inspect " + session.string() + "\n");
  }
  const Outcome outcome = run_there("calibrate bias --world honest --simulated=3 --fast --save kept.toml");
  EXPECT_EQ(outcome.code, 7);
  EXPECT_EQ(outcome.err, "the result is in kept.toml\n");
  EXPECT_TRUE(std::filesystem::exists(folder() / "kept.toml"));
  EXPECT_EQ(files(".h5").size(), 3U);
}

TEST_F(Unwritten, AFullStandardErrorChangesNoExitCode) {
  EXPECT_EQ(run("inspect missing.h5 2>/dev/full >out.txt #").code, 2);
}

}  // namespace
}  // namespace thermorig::tests
