// SPDX-License-Identifier: MIT
// A rig without a servo, by the built program.
#include <gmock/gmock.h>

#include "program.h"

namespace thermorig::tests {
namespace by_hand {

using ::testing::HasSubstr;
using ::testing::Not;

class NoServo : public ProgramTest {
 protected:
  /// A rest, a turn there and back, a rest.
  std::string recorded() const {
    const Outcome outcome =
        run("record --fast --json --simulated=4 --world honest --no-servo --seconds 50 -e kitchen");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const auto summary = outcome.lines().back();
    EXPECT_EQ(summary["verdict"], "good") << summary;
    EXPECT_TRUE(summary["lacking"].empty()) << summary;
    return summary.value("session", "");
  }
};

TEST_F(NoServo, MakesASessionThatEveryCommandTakes) {
  const std::string session = recorded();
  const Outcome inspected = run("inspect --check --json " + session);
  EXPECT_EQ(inspected.code, 0) << inspected.err;
  EXPECT_EQ(inspected.lines()[0][0]["label_source"], "gyro");
  EXPECT_THAT(run("inspect " + session).out, HasSubstr("labels       from the gyro"));
  EXPECT_EQ(run("reprocess " + session).code, 0);
  EXPECT_EQ(run("export --csv " + session).code, 0);
  const Outcome latency = run("calibrate latency --session " + session);
  EXPECT_EQ(latency.code, 0) << latency.err;
}

TEST_F(NoServo, SaysOfEvaluationsWhatTheirLabelsAreAndLeavesOutWhatSeesTheGyro) {
  const Outcome outcome = run("evaluate general " + recorded());
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("labels from the gyro (no servo)"));
  EXPECT_THAT(outcome.out, HasSubstr("cnn-thermal"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("gyro-kalman")));
}

TEST_F(NoServo, IsShownLiveWithoutScores) {
  const Outcome outcome = run("live --fast --simulated=4 --world honest --no-servo --seconds 12");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("no scores: without a servo"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("RMSE")));
}

TEST_F(NoServo, RefusesWordsThatNeedOne) {
  for (const std::string words : {"--no-servo --plan quick", "--no-servo --check", "--seconds 20",
                                  "--no-servo --simulated-servo 180"}) {
    SCOPED_TRACE(words);
    const Outcome outcome = run("record --fast --simulated=4 -e kitchen " + words);
    EXPECT_EQ(outcome.code, 2) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("try: "));
  }
  EXPECT_EQ(run("calibrate latency --fast --simulated=4 --no-servo").code, 2);
}

}  // namespace by_hand
}  // namespace thermorig::tests
