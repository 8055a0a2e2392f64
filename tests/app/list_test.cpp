// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <algorithm>
#include <sstream>

#include "program.h"

namespace thermorig::tests {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class List : public ProgramTest {
 protected:
  void record(const std::string& arguments, const std::string& plan = brief_plan) const {
    const bool has_world = arguments.find("--world") != std::string::npos;
    const Outcome outcome =
        run("record --fast --simulated=3 " + plan + " " + arguments + (has_world ? "" : " --world honest"));
    EXPECT_EQ(outcome.code, 0) << outcome.err;
  }

  /// Two in the kitchen, then one in the garden.
  void record_three() const {
    record("-e kitchen --licence CC-BY-4.0");
    record("-e kitchen", "--plan quick --speeds 40 --frames-per-leg 12");
    record("-e garden");
  }

  /// "garden 1", in the order in which they are listed.
  std::vector<std::string> listed(const std::string& arguments) const {
    const Outcome outcome = run("list --json " + arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const auto lines = outcome.lines();
    std::vector<std::string> names;
    if (lines.empty()) return names;
    for (const auto& session : lines[0])
      names.push_back(session.value("environment", "") + " " +
                      std::to_string(session.value("acquisition", 0)));
    return names;
  }
};

TEST_F(List, ShowsEverySessionOfAFolderByEnvironmentAndNumber) {
  record_three();
  const Outcome outcome = run("list");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const char* part :
       {"garden", "kitchen", "quick", "good", "SIMULATED honest", "recordings/garden/garden_acq-01_",
        "3 sessions: 3 good, 0 usable, 0 bad; 3 SIMULATED"})
    EXPECT_THAT(outcome.out, HasSubstr(part));
  EXPECT_THAT(listed(""), ElementsAre("garden 1", "kitchen 1", "kitchen 2"));
}

/// From the table's heading on: before it a terminal shows how far reading is.
std::size_t longest_line(const std::string& text) {
  std::size_t longest = 0;
  std::istringstream lines(text.substr(text.find("environment ")));
  for (std::string line; std::getline(lines, line);)
    longest = std::max(longest, line.find_last_not_of("\r\n") + 1);
  return longest;
}

TEST_F(List, LeavesOutOnATerminalWhatItHasNoRoomForAndSaysSo) {
  record_briefly();
  const std::string all = run("list").out;
  EXPECT_GT(longest_line(all), 120U) << "no terminal: nothing is left out";
  EXPECT_THAT(all, Not(HasSubstr("hidden columns")));
  const std::string usual = run_on_terminal("", "list").out;  // a terminal that does not say: 80
  EXPECT_LE(longest_line(usual), 80U);
  for (const char* part : {"garden", "good", "SIMULATED honest", "1 session: ", "hidden columns"})
    EXPECT_THAT(usual, HasSubstr(part));
  EXPECT_THAT(usual, testing::ContainsRegex("\n  recordings/garden/garden_acq-01_[0-9TZ]+\\.h5\r?\n"));
  const std::string wide =
      run_on_terminal("", "--version; stty cols 120; " + std::string(THERMORIG_PROGRAM) + " list").out;
  EXPECT_LE(longest_line(wide), 120U);
  EXPECT_THAT(wide, HasSubstr("  recordings/garden/garden_acq-01_"));
  EXPECT_THAT(wide, Not(HasSubstr("hidden columns")));
}

TEST_F(List, CutsALongNoteBetweenCharacters) {
  std::string umlauts;
  for (int i = 0; i < 60; ++i) umlauts += "ü";
  record("-e garden --note " + umlauts);
  record("-e garden --note x" + umlauts);  // of two such texts a cut in bytes splits a character of one
  const Outcome outcome = run("list");
  EXPECT_THAT(outcome.out, HasSubstr("ü..."));
  EXPECT_THAT(outcome.out, Not(HasSubstr("\\xC3"))) << "half a character, as it is shown";
}

TEST_F(List, IsSortedAndChosenFromAsIsAskedFor) {
  record_three();
  EXPECT_THAT(listed("--sort date"), ElementsAre("kitchen 1", "kitchen 2", "garden 1"));
  EXPECT_THAT(listed("--sort date --reverse"), ElementsAre("garden 1", "kitchen 2", "kitchen 1"));
  EXPECT_EQ(listed("--sort valid").front(), "kitchen 2");  // it had half as many speeds to drive
  EXPECT_THAT(listed("--environment kitchen recordings"), ElementsAre("kitchen 1", "kitchen 2"));
  EXPECT_THAT(listed("-e kitchen -e garden --verdict good --plan quick --simulated").size(), 3U);
  EXPECT_THAT(listed("--real"), ElementsAre());
  EXPECT_THAT(listed("--verdict bad"), ElementsAre());
  EXPECT_THAT(listed("recordings/garden"), ElementsAre("garden 1"));
  EXPECT_EQ(run("list --simulated --real").code, 2);
  EXPECT_THAT(run("list -e bathroom").out,
              HasSubstr("none of the 3 sessions there is what was asked for: environments garden, kitchen; "
                        "plans quick"));
  EXPECT_EQ(run("list nowhere").code, 2);
  EXPECT_THAT(run("list recordings/bathroom").err, HasSubstr("try: check the name: ls recordings\n"));
}

TEST_F(List, GivesWhatInspectSaysOfASessionAsJson) {
  record("-e kitchen --licence CC-BY-4.0 --world honest,gyro.bandwidth_hz=100");
  const auto listed = run("list --json").lines()[0][0];
  const auto inspected = run("inspect --json recordings").lines()[0][0];
  for (const char* key :
       {"file", "uuid", "environment", "acquisition", "start_time", "duration_s", "plan", "verdict",
        "verdict_reasons", "simulated", "licence", "frames", "frames_swept", "frames_valid"})
    EXPECT_EQ(listed[key], inspected[key]) << key;
  EXPECT_EQ(listed["world"], "honest,gyro.bandwidth_hz=100");
  EXPECT_EQ(listed["for_calibration"], false);
}

TEST_F(List, NamesAFileThatIsNoSessionAndShowsTheOthers) {
  record("-e garden");
  write("recordings/garden/notes.h5", std::vector<std::uint8_t>(100, 'x'));
  write("recordings/garden/left.journal", {});
  const Outcome outcome = run("list --verdict good");
  EXPECT_EQ(outcome.code, 8);
  EXPECT_THAT(outcome.err, HasSubstr("notes.h5"));
  EXPECT_THAT(outcome.out, HasSubstr("1 session: 1 good"));
  EXPECT_THAT(outcome.out, HasSubstr("1 journal: being recorded, or waiting for thermorig recover"));
  const auto last = run("list --json").lines()[0][1];
  EXPECT_EQ(last["exit_code"], 8);
  EXPECT_THAT(std::string(last["file"]), HasSubstr("notes.h5"));
}

TEST_F(List, IsMadeOfEveryCommandThatTakesSessions) {
  record("-e kitchen");
  record("-e garden");
  const Outcome inspected = run("inspect recordings");
  EXPECT_EQ(inspected.code, 0) << inspected.err;
  for (const char* part : {"recordings/garden/garden_acq-01_", "recordings/kitchen/kitchen_acq-01_"})
    EXPECT_THAT(inspected.out, HasSubstr(part));
  EXPECT_EQ(run("inspect --json recordings/garden recordings").lines()[0].size(), 3U);
  EXPECT_EQ(run("reprocess --json recordings").lines()[0].size(), 2U);
  EXPECT_EQ(run("calibrate latency --json --session recordings").lines().back()["sessions"].size(), 2U);
  std::filesystem::create_directory(folder() / "empty");
  for (const char* command : {"inspect empty", "reprocess empty", "list empty"}) {
    const Outcome refused = run(command);
    EXPECT_EQ(refused.code, 2) << command;
    EXPECT_THAT(refused.err, HasSubstr("there is no session (.h5) in it")) << command;
    EXPECT_THAT(refused.err, Not(HasSubstr("damaged"))) << command;
  }
}

}  // namespace
}  // namespace thermorig::tests
