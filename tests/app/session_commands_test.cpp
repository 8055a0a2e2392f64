// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <csignal>
#include <fstream>
#include <thread>

#include "program.h"
#include "support/file_text.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
namespace fs = std::filesystem;

class SessionCommands : public ProgramTest {
 protected:
  /// A journal as `kill -9` leaves it.
  std::filesystem::path killed_journal() {
    const pid_t process = start(
        {"record", "--world", "honest", "--simulated=3", "--fast", "--environment", "garden", "--json"});
    std::vector<std::filesystem::path> journals;
    while (journals.empty()) journals = files(".journal");
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    kill(process, SIGKILL);
    EXPECT_EQ(wait(process).code, 128 + SIGKILL);
    return journals[0];
  }
};

TEST_F(SessionCommands, InspectTellsWhatASessionHolds) {
  const auto session = record_briefly();
  const Outcome outcome = run("inspect " + session.string());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const char* part : {"SIMULATED (seed 3", "garden acquisition 1", "camera", "gyro", "servo",
                           "longest gap", "frames   ", "deg/s", "40.0", "80.0", "verdict  "})
    EXPECT_THAT(outcome.out, HasSubstr(part));
}

TEST_F(SessionCommands, InspectGivesAnArrayOfSessionsAsJson) {
  const auto session = record_briefly();
  const Outcome outcome = run("inspect --json " + session.string() + " " + session.string());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto lines = outcome.lines();
  ASSERT_EQ(lines.size(), 1U);
  ASSERT_EQ(lines[0].size(), 2U);
  const auto& first = lines[0][0];
  EXPECT_EQ(first["environment"], "garden");
  EXPECT_EQ(first["seed"], 3);
  EXPECT_GE(first["frames_swept"], 48);
  EXPECT_EQ(first["speeds"].size(), 4U);
  EXPECT_GT(first["streams"]["gyro"]["counters"]["messages"], 100);
}

TEST_F(SessionCommands, InspectNamesAnAttributeThatSomebodyHasChangedAndItsCheckFails) {
  const auto session = record_briefly();
  EXPECT_EQ(run("inspect --check " + session.string()).code, 0);
  std::string bytes = file_text(session);
  const std::string clock = "CLOCK_MONOTONIC";  // an attribute that is only for people
  ASSERT_EQ(bytes.find(clock), bytes.rfind(clock));
  bytes.replace(bytes.find(clock), clock.size(), "CLOCK_MONOTONIK");
  write(session.string(), {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  const Outcome shown = run("inspect " + session.string());
  EXPECT_EQ(shown.code, 0) << shown.err;
  for (const char* option : {"", "--timing "}) {
    const Outcome outcome = run("inspect --check " + std::string(option) + session.string());
    EXPECT_EQ(outcome.code, 9) << option;
    EXPECT_THAT(outcome.out,
                HasSubstr("altered  1 attribute is not as thermorig wrote it: /sync@host_clock\n"));
  }
  EXPECT_EQ(run("inspect --json " + session.string()).lines()[0][0]["altered"],
            nlohmann::json::array({"/sync@host_clock"}));
  ASSERT_EQ(run("reprocess " + session.string()).code, 0);
  const Outcome again = run("inspect --check " + session.string());
  EXPECT_EQ(again.code, 0);
  EXPECT_THAT(again.out, Not(HasSubstr("altered")));
}

TEST_F(SessionCommands, InspectRefusesWhatIsNoSessionAndStillShowsTheRest) {
  const std::string text = "frames, but not ours";
  write("notes.h5", {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  const auto session = record_briefly();
  const Outcome outcome = run("inspect --check notes.h5 " + session.string());
  EXPECT_EQ(outcome.code, 8);
  EXPECT_THAT(outcome.err, HasSubstr("notes.h5"));
  EXPECT_THAT(outcome.out, HasSubstr("verdict"));
  EXPECT_EQ(run("inspect .").code, 8);
}

TEST_F(SessionCommands, InspectSaysThatADamagedMapIsOne) {
  for (const std::string text : {"", "UHRMAP01"}) {
    write("kitchen.map", {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    const Outcome outcome = run("inspect kitchen.map");
    EXPECT_EQ(outcome.code, 8);
    EXPECT_THAT(outcome.err, HasSubstr("kitchen.map: this is not a map of thermorig"));
    EXPECT_THAT(outcome.err, HasSubstr("make it again from a recorded session: thermorig live --replay"));
  }
}

TEST_F(SessionCommands, InspectRefusesOfAMapWhatOnlySessionsHave) {
  const std::string text = "THRMAP01";
  write("kitchen.map", {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  const auto session = record_briefly();
  for (const std::string word : {"--check", "--timing"}) {
    const Outcome outcome = run("inspect " + word + " kitchen.map " + session.string());
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("kitchen.map: " + word + " is for sessions, and this is a map"));
    EXPECT_THAT(outcome.out, HasSubstr("verdict")) << "the others are shown";
  }
  const Outcome page = run("inspect --html page.html kitchen.map");
  EXPECT_EQ(page.code, 2);
  EXPECT_THAT(page.err, HasSubstr("--html is for sessions"));
}

TEST_F(SessionCommands, AFileThatIsNotThereIsBadUsageForEveryCommand) {
  for (const char* command : {"inspect", "reprocess", "recover", "decode --device camera"}) {
    const Outcome outcome = run(command + std::string(" missing.h5"));
    EXPECT_EQ(outcome.code, 2) << command;
    EXPECT_THAT(outcome.err, HasSubstr("no such file")) << command;
    EXPECT_THAT(outcome.err, HasSubstr("missing.h5")) << command;
  }
}

TEST_F(SessionCommands, InspectCheckFailsOnABadSession) {
  std::filesystem::resize_file(killed_journal(), 60'000);  // ends within the opening rest: no valid frame
  const Outcome recovered = run("recover recordings --json");
  EXPECT_EQ(recovered.code, 3) << recovered.err;
  const std::string session = recovered.lines()[0][0]["session"];
  EXPECT_EQ(run("inspect --json " + session).code, 0);
  const Outcome outcome = run("inspect --check --json " + session);
  EXPECT_EQ(outcome.code, 9) << outcome.err;
  EXPECT_EQ(outcome.lines()[0][0]["verdict"], "bad");
}

TEST_F(SessionCommands, ReprocessMakesTheSameSessionAgain) {
  const auto session = record_briefly();
  const auto before = run("inspect --json " + session.string()).lines()[0][0];
  const Outcome outcome = run("reprocess --json " + session.string());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.lines()[0][0]["frames_valid"], before["frames_valid"]);
  EXPECT_EQ(run("inspect --json " + session.string()).lines()[0][0], before);
}

TEST_F(SessionCommands, ReprocessSaysWhyAVerdictIsAnother) {
  const std::string session = record_briefly().string();
  std::ofstream(folder() / "turned.toml")
      << "name = \"bench\"\n[gyro]\nsign = -1\n"
         "[camera]\norientation_measured_utc = \"2026-11-20T10:00:00Z\"\n";
  const Outcome outcome = run("reprocess --rig turned.toml " + session);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, testing::ContainsRegex("verdict  good -> bad\n           [a-z]"));
  EXPECT_FALSE(run("reprocess --json " + session).lines()[0][0]["verdict_reasons"].is_null());
}

/// Of commands that take one session; of several sessions they say which to name.
TEST_F(SessionCommands, AFolderStandsForTheSessionInIt) {
  record_briefly();
  for (const char* words : {"annotate recordings --note x", "inspect --html page.html recordings",
                            "live --speed max --no-page --replay recordings", "export recordings --csv -o -"})
    EXPECT_EQ(run(words).code, 0) << words;
  record_briefly();
  for (const char* words :
       {"annotate recordings --note x", "inspect --html other.html recordings", "view recordings",
        "live --speed max --no-page --replay recordings", "export recordings --csv -o -"}) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 2) << words;
    EXPECT_THAT(outcome.err, HasSubstr("the folder holds 2 sessions, and one is needed")) << words;
    EXPECT_THAT(outcome.err, HasSubstr("recordings/garden/garden_acq-02_")) << words;
  }
}

TEST_F(SessionCommands, ExportTakesEverySessionOfAFolder) {
  record_briefly();
  record_briefly();
  const Outcome outcome = run("export recordings --csv --tum shaft -o made --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.lines().size(), 2U);
  EXPECT_EQ(files(".csv").size(), 2U);
  EXPECT_EQ(files(".tum").size(), 2U);
  EXPECT_EQ(run("export recordings --csv --npz -o made").code, 7) << "a table is there";
  EXPECT_TRUE(files(".npz").empty()) << "all files of a call, or none";
}

TEST_F(SessionCommands, ANextCommandCanBeTypedWhateverTheNames) {
  const Outcome outcome =
      run("record --world honest --simulated=3 --fast -e garden -o 'my data' " + brief_plan);
  const std::string next = outcome.out.substr(outcome.out.find("\nnext  thermorig ") + 17);
  EXPECT_EQ(run(next.substr(0, next.find('\n'))).code, 0) << next;
}

TEST_F(SessionCommands, InspectTellsOfAWarningOnlyWhereItIsNotThatOfEveryFrame) {
  run("record --world honest,camera.lost_subpages=0.17 --simulated=3 --fast -e kitchen " + brief_plan);
  EXPECT_THAT(run("inspect recordings/kitchen").out, testing::ContainsRegex("warned   camera_gap [0-9]+"));
  run("record --world typical --simulated=4 --fast -e garden " + brief_plan);  // begins with a cold camera
  const auto session = run("inspect --json recordings/garden").lines()[0][0];
  EXPECT_EQ(session["reasons"]["warm_up"], session["frames_swept"]);
  EXPECT_THAT(run("inspect recordings/garden").out, testing::Not(HasSubstr("warm_up")));
}

TEST_F(SessionCommands, RecoverMakesASessionOfAKilledRecording) {
  killed_journal();
  const Outcome outcome = run("recover recordings --json");
  EXPECT_TRUE(outcome.code == 0 || outcome.code == 3) << outcome.err;
  const auto result = outcome.lines()[0][0];
  EXPECT_EQ(result["result"], "recovered");
  EXPECT_EQ(outcome.code == 3, result["bytes_lost"] > 0) << result;
  ASSERT_EQ(files(".h5").size(), 1U);
  EXPECT_EQ(run("inspect " + files(".h5")[0].string()).code, 0);
}

TEST_F(SessionCommands, RecoverStatesWhatATruncatedJournalLost) {
  const auto journal = killed_journal();
  const std::string all = file_text(journal);
  const auto used = all.find_last_not_of('\0') + 1;  // the rest is reserve
  std::filesystem::resize_file(journal, used - 5);
  const Outcome outcome = run("recover " + journal.string());
  EXPECT_EQ(outcome.code, 3) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("are lost"));
  const Outcome again = run("recover " + journal.string() + " --json");
  EXPECT_EQ(again.code, 3) << again.out;
  EXPECT_GT(again.lines()[0][0]["bytes_lost"], 0);
  EXPECT_EQ(files(".h5").size(), 1U);
  EXPECT_EQ(again.lines()[0][0]["result"], "already there");
}

TEST_F(SessionCommands, RecoverMakesASessionOfOneThatWasCutShort) {
  const fs::path whole = record_briefly();
  const auto frames = run("inspect --json " + whole.string()).lines()[0][0]["frames"];
  const fs::path cut = folder() / "cut.h5";
  const auto size = fs::file_size(whole);
  fs::copy_file(whole, cut);
  fs::resize_file(cut, size * 3 / 4);
  for (const char* command : {"inspect ", "view ", "train ", "list ", "export --csv "}) {
    const Outcome refused = run(command + cut.string());
    EXPECT_EQ(refused.code, 8) << command;
    EXPECT_THAT(refused.err, HasSubstr("was cut short: ")) << command;
    EXPECT_THAT(refused.err, HasSubstr("thermorig recover " + cut.string())) << command;
  }
  for (int again = 0; again < 2; ++again) {  // the second time it is there already
    const Outcome outcome = run("recover " + cut.string());
    EXPECT_EQ(outcome.code, 3) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("cut_salvaged.h5"));
    EXPECT_THAT(outcome.out, HasSubstr("of the cut file are missing"));
  }
  const auto salvaged = run("inspect --json cut_salvaged.h5").lines()[0][0];
  EXPECT_EQ(salvaged["frames"], frames);
  EXPECT_EQ(salvaged["state"], "recovered");
  EXPECT_EQ(fs::file_size(cut), size * 3 / 4);
  fs::resize_file(cut, 10'000);
  EXPECT_EQ(run("recover " + cut.string()).code, 8);
}

TEST_F(SessionCommands, RecoverSaysWhenThereIsNothingToDo) {
  std::filesystem::create_directory(folder() / "empty");
  const Outcome outcome = run("recover empty");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.out, HasSubstr("nothing to recover"));
}

TEST_F(SessionCommands, RecoverRefusesWhatIsNoJournal) {
  write("notes.journal", std::vector<std::uint8_t>(100, 7));
  EXPECT_EQ(run("recover notes.journal").code, 8);
  EXPECT_EQ(run("recover missing").code, 2);
}

}  // namespace
}  // namespace thermorig::tests
