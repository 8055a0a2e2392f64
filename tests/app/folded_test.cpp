// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cstdlib>

#include "print/terminal_width.h"
#include "program.h"

namespace thermorig::tests {
namespace folding {
namespace {

using app::folded;

TEST(Folded, GoesOnBelowWhatStandsBehindTheLabel) {
  EXPECT_EQ(folded("verdict  good; the gyro hides its bias\n", 24),
            "verdict  good; the gyro\n         hides its bias\n");
  EXPECT_EQ(folded("  try: one thing, or another", 18), "  try: one thing,\n       or another");
  EXPECT_EQ(folded("two words  are a label", 18), "two words  are a\n           label");
  EXPECT_EQ(folded("no label here at all", 12), "no label\n  here at\n  all");
  EXPECT_EQ(folded("no label is here  ", 9), "no label\n  is here") << "blanks at the end make no line";
  EXPECT_EQ(folded("Which one? 1 to 3: ", 12), "Which one? 1\n  to 3: ") << "but stay before an answer";
}

TEST(Folded, LeavesWhatFits) {
  EXPECT_EQ(folded("a\n\nb  c\n", 5), "a\n\nb  c\n");
  EXPECT_EQ(folded("\u00b0\u00b0\u00b0 \u00b0", 5), "\u00b0\u00b0\u00b0 \u00b0") << "counted in characters";
}

TEST(Folded, BreaksNoPathAndNoCommandThatIsLongForOneAlone) {
  EXPECT_EQ(folded("next  thermorig inspect /a/very/long/path.h5", 30),
            "next  thermorig inspect /a/very/long/path.h5");
}

TEST(Folded, LeavesLinesThatSteerATerminal) {
  EXPECT_EQ(folded("\x1b[2K one two three", 8), "\x1b[2K one two three");
}

class MachineOutput : public ProgramTest {};

TEST_F(MachineOutput, IsNeverFolded) {
  const std::string session = record_briefly().string();
  const std::vector<std::string> commands{"list --json",
                                          "inspect --json --timing " + session,
                                          "export --csv -o - " + session,
                                          "export --tum=shaft -o - " + session,
                                          "dataset split recordings --json",
                                          "reprocess --json " + session,
                                          "evaluate general --json " + session,
                                          "list --nonsense --json"};
  for (const std::string& command : commands) {
    setenv("COLUMNS", "1000", 1);
    const Outcome wide = run(command);
    setenv("COLUMNS", "40", 1);
    const Outcome narrow = run(command);
    EXPECT_EQ(wide.out, narrow.out) << command;
    EXPECT_NE(wide.out, "") << command;
  }
}

class InspectPlots : public ProgramTest {};

TEST_F(InspectPlots, WriteFiguresOfASessionAndOverwriteNothing) {
  const std::string session = record_briefly().string();
  const Outcome drawn = run("inspect --plots plots " + session);
  if (drawn.err.find("built without node") != std::string::npos) GTEST_SKIP() << drawn.err;
  EXPECT_EQ(drawn.code, 0) << drawn.err;
  for (const char* name :
       {"fig-rates.svg", "fig-difference.svg", "fig-image.svg", "table-session.tex", "captions.csv"})
    EXPECT_TRUE(std::filesystem::exists(folder() / "plots" / name)) << name;
  const Outcome again = run("inspect --plots plots " + session);
  EXPECT_EQ(again.code, 7);
  EXPECT_NE(again.err.find("nothing is overwritten"), std::string::npos);
  EXPECT_EQ(run("inspect --plots other --html page.html " + session).code, 2);
}

}  // namespace
}  // namespace folding
}  // namespace thermorig::tests
