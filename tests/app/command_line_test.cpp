// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

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

TEST_F(CommandLine, SaysThatACameraIsAskedForItsRate) {
  for (const char* command : {"record", "live", "calibrate", "doctor"}) {
    const Outcome outcome = run(std::string(command) + " --help");
    EXPECT_THAT(outcome.out, HasSubstr("camera is asked for")) << command;
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

TEST_F(CommandLine, TakesNoNegativeNumberForALargeOne) {
  for (const char* words :
       {"simulate --seed=-1", "train . --seed=-1", "evaluate --study . -o s --seeds=1,-1",
        "evaluate --study . -o s --reference-seeds=-2", "decode --device gyro --lines=-1 dump.bin"}) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 2) << words;
    EXPECT_THAT(outcome.err, HasSubstr(" is negative")) << words;
  }
}

TEST_F(CommandLine, RefusesAValueThatIsEmptyWhateverOptionItIsOf) {
  for (const auto& [words, name] : {std::pair{"live --simulated --fast --map ''", "--map"},
                                    {"live --simulated --fast --map=", "--map"},
                                    {"record --environment garden --rig '' -n", "--rig"},
                                    {"calibrate bias --simulated --fast --save ''", "--save"},
                                    {"live --replay x.h5 --speed ''", "--speed"},
                                    {"record --environment garden -n --simulated=", "--simulated"},
                                    {"export x.h5 --npz -o ''", "-o"},
                                    {"annotate x.h5 --exclude 1..2 --reason ''", "--reason"}}) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 2) << words;
    EXPECT_THAT(outcome.err, HasSubstr("the value of " + std::string(name) + " is empty")) << words;
    EXPECT_THAT(outcome.err, HasSubstr("try: give " + std::string(name) + " a value")) << words;
  }
  EXPECT_THAT(run("inspect x.h5 ''").err, HasSubstr("word 3 of the command line is empty"));
}

TEST_F(CommandLine, SaysWhichNumberIsNone) {
  EXPECT_THAT(run("record --environment garden --speeds 30deg").err,
              HasSubstr("--speeds = 30deg is no number that it takes"));
  EXPECT_THAT(run("view --page-port 70000 x.h5").err, HasSubstr("70000 not in range 0 to 65535"));
}

TEST_F(CommandLine, RefusesARateOrASpeedThatNoRigHas) {
  const std::string record = "record --environment garden --simulated --fast ";
  for (const char* rate : {"0", "-8", "nan", "1e9"}) {
    const Outcome outcome = run(record + "--camera-rate=" + rate);
    EXPECT_EQ(outcome.code, 2) << rate;
    EXPECT_THAT(outcome.err, HasSubstr("output_rate_hz")) << rate;
    EXPECT_THAT(outcome.err, HasSubstr("try: a number from 0.1 to 64")) << rate;
  }
  EXPECT_THAT(run(record + "--speeds 0.001").err, HasSubstr("speeds from 0.01 to 300 deg/s"));
}

TEST_F(CommandLine, WrapsItsHelpBelowWhereAMeaningBegins) {
  const std::string help = run("calibrate --help").out;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80U) << line;
  EXPECT_THAT(help, HasSubstr("signs; lens: where\n" + std::string(30, ' ') + "pixels look"));
  EXPECT_THAT(run("record --help").out, testing::Not(HasSubstr("{false}")));
}

TEST_F(CommandLine, NamesAPathThatTheSystemRefuses) {
  std::filesystem::create_symlink("loop.h5", folder() / "loop.h5");
  const Outcome outcome = run("inspect loop.h5");
  EXPECT_EQ(outcome.code, 7);
  EXPECT_THAT(outcome.err, HasSubstr("thermorig: loop.h5: Too many levels of symbolic links\n  try: "));
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
  EXPECT_THAT(outcome.err, HasSubstr("try: the file that is here: --rig ./bench.toml"));
  std::ofstream(folder() / "garage.profile") << "name = \"bench\"\n";
  EXPECT_THAT(run("record --environment garden --rig garage.profile -n").err,
              HasSubstr("try: the file that is here: --rig ./garage.profile"));
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
