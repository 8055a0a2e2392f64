// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "program.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;

class CommandLine : public ProgramTest {};

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// The left column of a line of help: "-o,--output DIR"; empty of other lines.
std::string left_column(const std::string& line) {
  constexpr std::size_t width = 30;
  if (!line.starts_with("  ") || line.size() < 3 || line[2] == ' ' || line.starts_with("  thermorig"))
    return "";
  const std::string left =
      line.substr(2, line.size() > width && line[width - 1] == ' ' ? width - 2 : line.size());
  return left.substr(0, left.find_last_not_of(' ') + 1);
}

/// "record", ..., "dataset", "dataset build", ...: every command below `command`, as completion names them.
void add_commands(const std::function<std::string(const std::string&)>& complete, const std::string& command,
                  std::vector<std::string>& commands) {
  for (const std::string& line : lines_of(complete(command))) {
    const std::string name = line.substr(0, line.find('\t'));
    if (line.find('\t') == std::string::npos || name.starts_with('-') || name == "help") continue;
    const std::string inner = command.empty() ? name : command + " " + name;
    commands.push_back(inner);
    add_commands(complete, inner, commands);
  }
}

class EveryCommand : public CommandLine {
 protected:
  EveryCommand() {
    add_commands([this](const std::string& command) { return run("complete " + command + " ''").out; }, "",
                 commands);
  }
  std::vector<std::string> commands;
};

TEST_F(EveryCommand, HasHelpWithAnExampleThatFits80Columns) {
  setenv("COLUMNS", "80", 1);
  EXPECT_GE(commands.size(), 20U);
  for (const std::string& command : commands) {
    const Outcome outcome = run(command + " --help");
    EXPECT_EQ(outcome.code, 0) << command;
    EXPECT_THAT(outcome.out, HasSubstr("Example")) << command;
    EXPECT_THAT(outcome.out, HasSubstr("thermorig " + command)) << command;
    EXPECT_EQ(outcome.err, "") << command;
    for (const std::string& line : lines_of(outcome.out))
      EXPECT_LE(line.size(), 80U) << command << ": " << line;
  }
}

TEST_F(EveryCommand, HasAManPageOfItsOwnOptions) {
  ASSERT_EQ(run("help --man man").code, 0);
  for (const std::string& command : commands) {
    const std::string name = command.substr(0, command.find(' '));
    std::ifstream file(folder() / "man" / ("thermorig-" + name + ".1"));
    const std::string page((std::istreambuf_iterator<char>(file)), {});
    EXPECT_THAT(page, HasSubstr("\n.SH NAME\nthermorig\\-" + name + " \\- ")) << command;
    for (const std::string& line : lines_of(run("complete " + command + " -").out)) {
      std::string option = line.substr(0, line.find('\t'));
      for (std::size_t at = 0; (at = option.find('-', at)) != std::string::npos; at += 2)
        option.insert(at, "\\");
      EXPECT_THAT(page, HasSubstr(option)) << command;
    }
  }
}

TEST_F(EveryCommand, GivesTheSameHelpIfAskedWithTheWord) {
  for (const std::string& command : commands)
    EXPECT_EQ(run("help " + command).out, run(command + " --help").out) << command;
  EXPECT_EQ(run("help").out, run("--help").out);
  EXPECT_EQ(run("help recrod").code, 2);
}

/// Those that take more say so in their help: "PATH...".
TEST_F(EveryCommand, HasNoOptionThatTakesMoreThanOneWord) {
  std::vector<std::string> greedy;
  for (const std::string& command : commands)
    for (const std::string& line : lines_of(run(command + " --help").out))
      if (const std::string left = left_column(line); left.starts_with('-')) {
        EXPECT_EQ(left.find_first_of("{}:"), std::string::npos) << command << ": " << line;
        if (left.ends_with("...") && !left.ends_with(",...")) greedy.push_back(command + " " + left);
      }
  EXPECT_THAT(greedy, testing::ElementsAre("calibrate --session PATH..."));
}

TEST_F(CommandLine, LeavesTheFileThatFollowsAnOptionToTheCommand) {
  for (const char* words :
       {"evaluate --study -o s --nf 2,3 left", "evaluate --study -o s --nr 1,2 left",
        "evaluate --study -o s --seeds 1,2 left", "evaluate --study -o s --reference-seeds 1,2 left",
        "decode --device gyro --gyro-protocol text --columns 7,8,9 left",
        "decode --device gyro --gyro-protocol mavlink --gyro-setting raw_scale_dps=0.0573 left",
        "list --environment garden left", "list --plan quick left", "list --verdict good left",
        "dataset build --title T --author A left", "export --csv gyro left", "export --csv left",
        "export --npz rows left", "export --mcap zstd left", "export --tum shaft left"}) {
    const Outcome outcome = run(words);
    EXPECT_EQ(outcome.code, 2) << words;
    EXPECT_THAT(outcome.err, HasSubstr("thermorig: left: there is no such file")) << words;
  }
  for (const char* words : {"live --replay none.h5 --estimators gyro,odometer left",
                            "record -e garden --simulated --fast --speeds 30,60 left"})
    EXPECT_THAT(run(words).err, HasSubstr("\"left\" was not expected")) << words;
}

TEST_F(CommandLine, TakesNoOptionForTheValueThatMayBeLeftOut) {
  EXPECT_THAT(run("export --tum -o out left").err, HasSubstr("left: there is no such file"));
}

TEST_F(CommandLine, TheDoctorSaysNothingOfARigThatItDidNotLookAt) {
  const Outcome outcome = run("doctor");
  EXPECT_THAT(outcome.out, HasSubstr("verdict  no rig was checked; this computer is fit to record"));
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
  EXPECT_EQ(run("recrod").err,
            "thermorig: there is no command \"recrod\"\n  try: did you mean record? thermorig --help\n");
  EXPECT_THAT(run("dataset biuld").err, HasSubstr("try: did you mean build? thermorig dataset --help"));
  EXPECT_THAT(run("dataset verify . --jsn").err, HasSubstr("did you mean --json? thermorig dataset verify"));
  EXPECT_THAT(run("help dataset biuld").err, HasSubstr("try: did you mean build? thermorig dataset --help"));
  EXPECT_THAT(run("help dataset build").out, HasSubstr("thermorig dataset build"));
  EXPECT_EQ(run("dataset").err, "thermorig: a command is missing\n  try: thermorig dataset --help\n");
  for (const char* words : {"photograph", "halp", "help help"})
    EXPECT_THAT(run(words).err, HasSubstr("try: thermorig --help")) << words;
  EXPECT_THAT(run("train --x").err, HasSubstr("try: thermorig train --help"));
  EXPECT_THAT(run("list --a").err, HasSubstr("try: thermorig list --help"));
}

TEST_F(CommandLine, NamesTheValueThatIsNearest) {
  EXPECT_THAT(run("record -e a --simulated-servo winsh").err, HasSubstr("did you mean \"winch\"?"));
  EXPECT_THAT(run("train --preset bst").err, HasSubstr("did you mean \"best\"?"));
  EXPECT_THAT(run("calibrate lattency").err, HasSubstr("did you mean \"latency\"?"));
  EXPECT_THAT(run("record --simulated -e a --plan quik").err, HasSubstr("did you mean \"quick\"?"));
  // Not that --environment is missing: the slip is in the word that stands for it.
  EXPECT_THAT(run("record --enviroment a").err,
              HasSubstr("there is no option --enviroment\n  try: did you mean --environment?"));
}

TEST_F(CommandLine, SaysWhatToWriteForAnOptionThatIsGone) {
  for (const char* word : {"end", "frame"})
    EXPECT_THAT(run("record -e a --simulated --sync " + std::string(word)).err,
                HasSubstr("--sync takes milliseconds"))
        << word;
  EXPECT_THAT(run("train a.h5 --cache=/var/tmp").err, HasSubstr("allow more --memory"));
  EXPECT_THAT(run("evaluate --study a.h5 -o b --job 4").err,
              AllOf(HasSubstr("--jobs N"), HasSubstr("--shard I/N")));
  EXPECT_THAT(run("export a.onnx --odometer").err, HasSubstr("--c-header"));
  EXPECT_THAT(run("record -e a --simulated --cache=/var/tmp").err,
              AllOf(HasSubstr("there is no option --cache"), Not(HasSubstr("--memory"))));
}

TEST_F(CommandLine, CompletesCommandsOptionsAndValues) {
  const auto complete = [this](const std::string& words) {
    std::vector<std::string> found;
    for (const std::string& line : lines_of(run("complete " + words).out))
      found.push_back(line.substr(0, line.find('\t')));
    return found;
  };
  std::filesystem::create_directories(folder() / "recordings/attic");
  std::filesystem::create_directories(folder() / "settings/thermorig");
  for (const char* name : {"settings/thermorig/bench.toml", "a.h5", "a.txt", "plan.toml"})
    std::ofstream(folder() / name);
  EXPECT_THAT(complete("rec"), testing::ElementsAre("record", "recover"));
  EXPECT_THAT(complete("help loo"), testing::ElementsAre("look"));
  EXPECT_THAT(complete("dataset v"), testing::ElementsAre("verify"));
  EXPECT_THAT(complete("record --operat"), testing::ElementsAre("--operator"));
  EXPECT_THAT(complete("annotate a.h5 --un"), testing::ElementsAre("--undo"));
  EXPECT_THAT(complete("record --simulated-gyro ''"), testing::ElementsAre("calibrated", "raw", "typical"));
  EXPECT_THAT(complete("export a.h5 --csv=g"), testing::ElementsAre("--csv=gyro"));
  EXPECT_THAT(complete("record -e a"), testing::ElementsAre("attic"));
  EXPECT_THAT(complete("record --plan p"), testing::ElementsAre("paper", "plan.toml"));
  EXPECT_THAT(complete("view a"), testing::ElementsAre("a.h5"));
  EXPECT_THAT(complete("list rec"), testing::ElementsAre("recordings/"));
  setenv("XDG_CONFIG_HOME", (folder() / "settings").c_str(), 1);
  EXPECT_THAT(complete("record --rig b"), testing::ElementsAre("bench"));
  unsetenv("XDG_CONFIG_HOME");
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
              HasSubstr("--speeds = 30deg is not a number"));
  EXPECT_THAT(run("view --page-port 70000 x.h5").err, HasSubstr("70000 is not a number from 0 to 65535"));
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

TEST_F(CommandLine, NamesAPathThatTheSystemRefuses) {
  const std::string name(300, 'x');
  const Outcome outcome = run("inspect " + name);
  EXPECT_EQ(outcome.code, 7);
  EXPECT_THAT(outcome.err, HasSubstr("thermorig: " + name + ": File name too long\n  try: "));
}

TEST_F(CommandLine, TakesASeedThatIsNotJoinedToItsWord) {
  const std::string record = "record --environment garden --json -n --simulated";
  EXPECT_EQ(run(record + " 3").out, run(record + "=3").out);
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
