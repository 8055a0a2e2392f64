// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include "program.h"
#include "support/file_text.h"

namespace thermorig::tests {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Annotate : public ProgramTest {
 protected:
  nlohmann::json inspected(const std::string& session) const {
    return run("inspect --json " + session).lines()[0][0];
  }

  /// Runs it, and gives what it says.
  nlohmann::json annotate(const std::string& session, const std::string& words) const {
    const Outcome outcome = run("annotate --json " + session + " " + words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const auto lines = outcome.lines();
    return lines.empty() ? nlohmann::json() : lines[0];
  }
};

TEST_F(Annotate, KeepsANoteThatListAndInspectShow) {
  const std::string session = record_briefly().string();
  annotate(session, "--note 'the window was open'");
  annotate(session, "--note 'and the heating on'");
  EXPECT_THAT(run("inspect " + session).out, HasSubstr("the window was open"));
  EXPECT_EQ(run("list --json").lines()[0][0]["notes"],
            nlohmann::json::array({"the window was open", "and the heating on"}));
  EXPECT_EQ(run("inspect --check " + session).code, 0);
  annotate(session, "--undo");
  EXPECT_EQ(run("list --json").lines()[0][0]["notes"], nlohmann::json::array({"the window was open"}));
}

TEST_F(Annotate, ExcludesFramesUntilItIsUndone) {
  const std::string session = record_briefly().string();
  const auto before = inspected(session);
  const auto done = annotate(session, "--exclude 5..8 --reason 'a hand in the image'");
  EXPECT_GT(done["frames_changed"], 15);
  EXPECT_LT(done["frames_valid"], before["frames_valid"]);
  const auto after = inspected(session);
  EXPECT_EQ(after["frames_valid"], done["frames_valid"]);
  EXPECT_GT(after["reasons"]["operator"], 10);
  EXPECT_EQ(after["annotations"][0]["text"], "a hand in the image");
  EXPECT_EQ(run("reprocess " + session).code, 0);
  EXPECT_EQ(inspected(session), after);
  annotate(session, "--undo");
  EXPECT_EQ(inspected(session), before);
}

TEST_F(Annotate, ExcludesAWholeSessionWhichListTells) {
  const std::string session = record_briefly().string();
  for (const char* span : {"all", "0..1000"}) {
    const auto done = annotate(session, std::string("--reason 'the camera was covered' --exclude ") + span);
    EXPECT_EQ(done["frames_valid"], 0) << span;
    EXPECT_EQ(done["verdict"], "bad");
    EXPECT_THAT(run("inspect " + session).out, HasSubstr("no frame is valid: all were excluded"));
    const std::string listed = run("list").out;
    EXPECT_THAT(listed, HasSubstr(span == std::string("all") ? "all frames excluded: the camera was covered"
                                                             : "0..1000 s excluded: the camera was covered"));
    EXPECT_THAT(listed, HasSubstr("; 1 with excluded frames"));
    const auto exclusions = run("list --json").lines()[0][0]["exclusions"];
    EXPECT_EQ(exclusions.size(), 1U);
    EXPECT_EQ(exclusions[0]["text"], "the camera was covered");
    annotate(session, "--undo");
  }
  EXPECT_THAT(run("annotate " + session + " --exclude everything").err, HasSubstr("or --exclude all"));
}

TEST_F(Annotate, MovesASessionToTheNextFreeNumberOfAnotherEnvironmentAndBack) {
  const std::string session = record_briefly().string();
  ASSERT_EQ(run("record --fast --world honest --simulated=5 -e kitchen " + brief_plan).code, 0);
  const std::string moved = annotate(session, "--environment kitchen")["file"];
  EXPECT_THAT(moved, HasSubstr("recordings/kitchen/kitchen_acq-02_"));
  EXPECT_FALSE(std::filesystem::exists(session));
  const auto said = inspected(moved);
  EXPECT_EQ(said["environment"], "kitchen");
  EXPECT_EQ(said["acquisition"], 2);
  EXPECT_EQ(run("list --json -e kitchen").lines()[0].size(), 2U);
  EXPECT_EQ(run("reprocess " + moved).code, 0);
  EXPECT_EQ(inspected(moved)["environment"], "kitchen");
  EXPECT_EQ(annotate(moved, "--undo")["file"], session);
  EXPECT_EQ(inspected(session)["environment"], "garden");
}

TEST_F(Annotate, DoesNotMoveASessionAwayFromItsJournal) {
  const std::filesystem::path session = record_briefly();
  write(std::filesystem::path(session).replace_extension(".journal").string(),
        std::vector<std::uint8_t>(10, 0));
  const Outcome outcome = run("annotate " + session.string() + " --environment kitchen");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("its journal is still beside it"));
  EXPECT_EQ(run("annotate " + session.string() + " --note x").code, 0);
}

TEST_F(Annotate, DoesNotGoBackWhereAnotherHasTakenItsNumber) {
  const std::string session = record_briefly().string();
  const std::string moved = annotate(session, "--environment kitchen")["file"];
  record_briefly();  // garden 1 was free
  const Outcome outcome = run("annotate " + moved + " --undo");
  EXPECT_EQ(outcome.code, 7);
  EXPECT_THAT(outcome.err, HasSubstr("another one has become garden acquisition 1"));
  EXPECT_EQ(inspected(moved)["environment"], "kitchen");
}

TEST_F(Annotate, KeepsWhatOthersHaveAddedToTheFile) {
  const std::string session = record_briefly().string();
  const std::string add =
      "/usr/bin/python3 -c \"import h5py; h5py.File('" + session + "', 'r+').attrs['mine'] = 'kept'\"";
  ASSERT_EQ(std::system(add.c_str()), 0);
  annotate(session, "--note x");
  const std::string read =
      "/usr/bin/python3 -c \"import h5py; assert h5py.File('" + session + "')['/'].attrs['mine'] == 'kept'\"";
  EXPECT_EQ(std::system(read.c_str()), 0);
}

TEST_F(Annotate, RefusesWhatCannotBeAndLeavesTheFileAsItIs) {
  const std::string session = record_briefly().string();
  const std::string before = file_text(session);
  for (const char* words : {"", "--undo", "--note x --undo", "--note ''", "--exclude 12", "--exclude 14..12",
                            "--exclude a..b", "--exclude 900..901", "--environment garden",
                            "--environment ../up", "--reason why", "--note x --reason why"})
    EXPECT_EQ(run("annotate " + session + " " + words).code, 2) << words;
  EXPECT_EQ(run("annotate missing.h5 --note x").code, 2);
  write("notes.h5", std::vector<std::uint8_t>(100, 'x'));
  EXPECT_EQ(run("annotate notes.h5 --note x").code, 8);
  EXPECT_EQ(file_text(session), before);
}

TEST_F(Annotate, IsNotNeededForWhatIsKnownWhenItIsRecorded) {
  const Outcome recorded =
      run("record --fast --world honest --simulated=3 -e garden --operator 'A. Person' --place 'room 2.11' " +
          ("--note 'the first of three' " + brief_plan));
  ASSERT_EQ(recorded.code, 0) << recorded.err;
  const auto said = inspected("recordings");
  EXPECT_EQ(said["operator"], "A. Person");
  EXPECT_EQ(said["place"], "room 2.11");
  EXPECT_EQ(said["note"], "the first of three");
  EXPECT_EQ(run("list --json").lines()[0][0]["notes"], nlohmann::json::array({"the first of three"}));
  EXPECT_EQ(run("record --fast --world honest --simulated=3 -e garden --note \"$(printf 'two\\nlines')\" " +
                brief_plan)
                .code,
            2);
}

}  // namespace
}  // namespace thermorig::tests
