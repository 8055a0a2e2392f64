// SPDX-License-Identifier: MIT
// Names of files, attributes of sessions and names in plans come from outside: none of them may reach a
// terminal as it is.
#include <gmock/gmock.h>

#include <fstream>
#include <sstream>

#include "program.h"
#include "thermorig/core/printable.h"

namespace thermorig::tests {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

/// A line break, an escape sequence, a turn of direction, and a byte that is no UTF-8.
const std::string hostile = "a\nFORGED\x1b[2J\u202E\xFF";

class OutsideText : public ProgramTest {
 protected:
  OutsideText() { fs::create_directory(folder() / hostile); }

  static void expect_clean(const std::string& text, const std::string& arguments) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
      EXPECT_EQ(printable(line), line) << arguments;
      EXPECT_FALSE(line.starts_with("FORGED")) << arguments;
    }
  }

  /// With and without --json.
  void expect_clean(const std::string& arguments) const {
    for (const char* form : {"", " --json"}) {
      const Outcome outcome = run(arguments + form);
      expect_clean(outcome.out, arguments + form);
      expect_clean(outcome.err, arguments + form);
      EXPECT_FALSE(outcome.out.empty() && outcome.err.empty()) << arguments;
    }
  }

  /// A file in the hostile folder, for the shell.
  static std::string in_folder(const std::string& name) { return "'" + hostile + "/" + name + "'"; }

  void record_there(const std::string& words) const {
    const Outcome outcome = run("record --world honest --simulated=3 --fast --environment garden -o " +
                                in_folder("r") + " " + words);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    expect_clean(outcome.out, "record");
  }
};

TEST_F(OutsideText, OfSessionsAndFilesReachesNoTerminalAsItIs) {
  record_there(brief_plan + " --licence 'CC-BY\u202E4.0'");
  fs::rename(files(".h5").at(0), folder() / hostile / "s.h5");
  const std::string session = in_folder("s.h5");
  EXPECT_THAT(run("inspect " + session).out, HasSubstr("CC-BY\\u{202E}4.0"));
  for (const std::string& command :
       {"inspect " + session, "inspect --timing " + session, "inspect " + in_folder("missing.h5"),
        "inspect " + in_folder(""), "reprocess " + session, "recover " + in_folder(""),
        "live --speed max --no-page --replay " + session, "calibrate bias --session " + session,
        "decode --device camera " + session, "doctor -o " + in_folder("") + " --rig " + in_folder("p.toml"),
        "ports " + in_folder("port"), "record --environment " + in_folder(""),
        "record --environment garden --camera " + in_folder("1") + " --gyro 2 --servo 3 -n",
        "train " + in_folder("none"), in_folder("word")})
    expect_clean(command);
}

TEST_F(OutsideText, OfPlansAndModelsReachesNoTerminalAsItIs) {
  std::ofstream(folder() / hostile / "plan.toml")
      << "name = \"x\\u001b[2J\\u202e\"\nframes_per_leg = 12\nleg_rates_dps = [40, 80]\nopening_rest_s = 2\n"
         "closing_rest_s = 2\n";
  record_there("--plan " + in_folder("plan.toml"));
  expect_clean("record --world honest --simulated=3 --fast --environment garden -n --plan " +
               in_folder("plan.toml"));
  const std::string model = in_folder("model.onnx");
  const Outcome trained =
      run("train " + in_folder("") + " --preset paper --nf 2 --nr 3 --epochs 1 -o " + model);
  ASSERT_EQ(trained.code, 0) << trained.err;
  expect_clean(trained.out, "train");
  expect_clean("evaluate " + model + " " + in_folder(""));
  expect_clean("export " + model + " --batch 1 -o " + in_folder("e"));
}

TEST_F(OutsideText, SpeedsThatRanOneWayHaveADashForTheOther) {
  std::ofstream(folder() / "plan.toml") << "frames_per_leg = 12\nleg_rates_dps = [40, 80]\n"
                                           "opening_rest_s = 2\nclosing_rest_s = 2\n";
  record_there("--plan plan.toml");
  fs::rename(files(".h5").at(0), folder() / "s.h5");
  const Outcome outcome = run("inspect --timing s.h5");
  expect_clean(outcome.out, "inspect --timing");
  EXPECT_THAT(outcome.out, Not(HasSubstr("\\u{01}")));
  EXPECT_THAT(outcome.out, testing::ContainsRegex("40\\.0 .* -"));  // never driven the other way
}

}  // namespace
}  // namespace thermorig::tests
