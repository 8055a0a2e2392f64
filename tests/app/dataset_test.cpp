// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include "program.h"
#include "support/file_text.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;

class DataSet : public ProgramTest {
 protected:
  void record(const std::string& environment, int seed) const {
    EXPECT_EQ(run("record --fast --world honest --simulated=" + std::to_string(seed) + " -e " + environment +
                  " " + brief_plan)
                  .code,
              0);
  }

  /// Two environments, a calibration, described.
  void build() const {
    record("garden", 3);
    record("kitchen", 4);
    EXPECT_EQ(run("calibrate bias --world honest --simulated=3 --fast").code, 0);
    const Outcome outcome =
        run("dataset build recordings --title 'Two rooms' --author 'A. Person' --licence CC-BY-4.0 --json");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.lines()[0]["sessions"], 3);
    EXPECT_EQ(outcome.lines()[0]["folds"], 2);
  }
};

TEST_F(DataSet, IsDescribedAndVerifiedUntilAByteIsAnotherOne) {
  build();
  EXPECT_EQ(run("dataset verify recordings").code, 0);
  const std::string command =
      "cd " + (folder() / "recordings").string() + " && sha256sum --quiet -c SHA256SUMS";
  EXPECT_EQ(std::system(command.c_str()), 0);
  const auto session = files(".h5")[1];
  std::string bytes = file_text(session);
  bytes[bytes.size() / 2] ^= 1;
  write(session.string(), {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  const Outcome outcome = run("dataset verify recordings");
  EXPECT_EQ(outcome.code, 9);
  EXPECT_THAT(outcome.out, HasSubstr(session.lexically_relative(folder() / "recordings").string()));
  EXPECT_EQ(run("dataset verify recordings --json").lines()[0]["differences"].size(), 1U);
}

TEST_F(DataSet, IsSplitSoThatTrainTakesAPart) {
  build();
  const Outcome paths = run("dataset split recordings --environment garden --part training");
  ASSERT_EQ(paths.code, 0) << paths.err;
  EXPECT_THAT(paths.out, ::testing::MatchesRegex("recordings/kitchen/kitchen_acq-01_[^\n]*\n"));
  const auto start = run("train --json --epochs 1 --no-choose-epoch $(" + std::string(THERMORIG_PROGRAM) +
                         " dataset split recordings --environment garden --part training)")
                         .lines()[0];
  EXPECT_EQ(start["environments"].size(), 1U);
  EXPECT_TRUE(start["environments"].contains("kitchen"));
  EXPECT_EQ(run("dataset split recordings --json").lines()[0]["folds"].size(), 2U);
  EXPECT_EQ(run("dataset split recordings --environment attic").code, 2);
  EXPECT_EQ(run("dataset split recordings/garden").code, 2);
}

TEST_F(DataSet, IsNotWrittenOverUnlessThatIsAskedFor) {
  build();
  const std::string before = file_text(folder() / "recordings/DATA_CARD.md");
  EXPECT_EQ(run("dataset build recordings --title Other").code, 7);
  EXPECT_EQ(file_text(folder() / "recordings/DATA_CARD.md"), before);
  EXPECT_EQ(run("dataset build recordings --title Other --replace").code, 0);
  EXPECT_THAT(file_text(folder() / "recordings/DATA_CARD.md"), HasSubstr("# Other\n"));
  EXPECT_EQ(run("dataset verify recordings").code, 0);
}

TEST_F(DataSet, RefusesWordsAndFoldersThatMakeNone) {
  record("garden", 3);
  for (const char* words :
       {"", "build recordings", "build nowhere --title x", "build recordings --title x --date today",
        "build recordings --title x --date 2026-13-45", "verify recordings", "verify nowhere",
        "split recordings --part test"})
    EXPECT_EQ(run("dataset " + std::string(words)).code, 2) << words;
  EXPECT_TRUE(files(".json").empty());
}

}  // namespace
}  // namespace thermorig::tests
