// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <fstream>

#include "program.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;

class CommandLine : public ProgramTest {};

TEST_F(CommandLine, GivesHelpWithAnExampleForEveryCommand) {
  for (const char* command : {"ports", "simulate", "record", "list", "annotate", "dataset", "inspect",
                              "recover", "reprocess", "decode"}) {
    const Outcome outcome = run(std::string(command) + " --help");
    EXPECT_EQ(outcome.code, 0) << command;
    EXPECT_THAT(outcome.out, HasSubstr("Example")) << command;
    EXPECT_THAT(outcome.out, HasSubstr(std::string("thermorig ") + command)) << command;
    EXPECT_EQ(outcome.err, "") << command;
  }
}

TEST_F(CommandLine, DoesNotSayThatACameraIsToldItsRate) {
  for (const char* command : {"record", "live", "calibrate", "doctor"}) {
    const Outcome outcome = run(std::string(command) + " --help");
    EXPECT_THAT(outcome.out, HasSubstr("camera was set to")) << command;
    EXPECT_THAT(outcome.out, testing::Not(HasSubstr("asked for"))) << command;
  }
}

TEST_F(CommandLine, SaysThatACommandIsMissing) {
  const Outcome outcome = run("");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err, "thermorig: a command is missing\n  try: thermorig --help\n");
}

TEST_F(CommandLine, NamesTheWordThatItDoesNotKnow) {
  const Outcome outcome = run("record --environment garden --simulatd");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("--simulatd"));
  EXPECT_THAT(outcome.err, HasSubstr("try: did you mean --simulated? thermorig record --help"));
  EXPECT_THAT(run("recrod").err, HasSubstr("try: did you mean record? thermorig --help"));
  EXPECT_THAT(run("dataset biuld").err, HasSubstr("try: did you mean build? thermorig dataset --help"));
  EXPECT_THAT(run("dataset verify . --jsn").err, HasSubstr("did you mean --json? thermorig dataset verify"));
  EXPECT_THAT(run("photograph").err, HasSubstr("try: thermorig --help"));
}

TEST_F(CommandLine, RefusesASeedThatIsNoNumber) {
  for (const char* seed : {"=abc", "=-1", "=1.5", "=99999999999999999999999"}) {
    const Outcome outcome = run(std::string("record --environment garden --fast --simulated") + seed);
    EXPECT_EQ(outcome.code, 2) << seed;
    EXPECT_THAT(outcome.err, HasSubstr("seed")) << seed;
  }
}

TEST_F(CommandLine, SaysThatTheSeedBelongsToTheWord) {
  const Outcome outcome = run("record --environment garden --fast --simulated 3");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("try: --simulated=3"));
}

TEST_F(CommandLine, PointsToAProfileThatLiesHere) {
  std::ofstream(folder() / "bench.toml") << "name = \"bench\"\n";
  const Outcome outcome = run("record --environment garden --rig bench -n");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("try: --rig ./bench.toml"));
  EXPECT_THAT(run("record --environment garden --rig other -n").err,
              HasSubstr("thermorig ports --save other"));
}

TEST_F(CommandLine, TellsAnErrorAsJsonTooWhereJsonIsAskedFor) {
  const Outcome outcome = run("record --json --environment a/b --simulated --fast");
  ASSERT_EQ(outcome.code, 2);
  const auto lines = outcome.lines();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0]["event"], "error");
  EXPECT_EQ(lines[0]["exit_code"], 2);
}

TEST_F(CommandLine, RefusesANameOfAnEnvironmentInTheSameWordsWhereverItStands) {
  const Outcome record = run("record --simulated --fast -e Wohnzimmer");
  const Outcome simulate = run("simulate -e Wohnzimmer --profile simulated.toml");
  EXPECT_EQ(simulate.code, 2);
  EXPECT_EQ(simulate.err, record.err);
  EXPECT_THAT(simulate.err, HasSubstr("\"Wohnzimmer\" cannot be the name of an environment"));
  EXPECT_THAT(simulate.out, ::testing::IsEmpty());
  EXPECT_TRUE(files(".toml").empty());
}

TEST_F(CommandLine, NamesVersionCommitCompilerAndLibraries) {
  EXPECT_THAT(run("--version").out, HasSubstr("thermorig "));
  const Outcome outcome = run("--version --json");
  ASSERT_EQ(outcome.code, 0);
  const auto lines = outcome.lines();
  ASSERT_EQ(lines.size(), 1U);
  for (const char* key : {"version", "git", "compiler", "libraries", "avr_image"})
    EXPECT_TRUE(lines[0].contains(key)) << key;
  EXPECT_NE(lines[0]["libraries"]["HDF5"], "");
}

TEST_F(CommandLine, FailsWhenItsOutputCannotBeWritten) {
  const Outcome outcome = run("--version --json >/dev/full; echo $? >code.txt; cat code.txt");
  EXPECT_THAT(outcome.out, HasSubstr("7"));
}

}  // namespace
}  // namespace thermorig::tests
