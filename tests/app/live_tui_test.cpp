// SPDX-License-Identifier: MIT
#include "live/live_tui.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <limits>
#include <string>
#include <thread>

#include "../support/paper_estimates.h"

namespace thermorig::app {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// A screen whose terminal is a pipe.
class LiveTui : public ::testing::Test {
 protected:
  LiveTui() {
    EXPECT_EQ(pipe(ends_.data()), 0);
    output_ = std::make_unique<OutputWriter>(OutputOptions{.descriptor = ends_[1], .waits = true});
    screen_ = make_live_tui(*output_, Colours::cube);
    progress_.sweep.phase = rig::SweepPhase::leg;
    progress_.sweep.leg = 3;
    progress_.sweep.leg_count = 8;
    for (const EstimatorColumn& column : paper_columns) scores_.estimators.push_back({.name = column.name});
    row_.rate_commanded_dps = 90.0F;
    gyro_dps(row_) = 94.5F;
    thermal_dps(row_) = 88.0F;
    fusion_dps(row_) = 91.0F;
    kg(row_) = 0.25F;
    row_.counted = true;
    sample_.valid = true;
    frame_.frame.temp_c.fill(22.0F);
  }
  ~LiveTui() override {
    output_.reset();
    for (const int end : ends_) close(end);
  }

  /// What a frame draws after such progress; less than a pipe holds.
  std::string drawn() {
    screen_->state(progress_);
    std::this_thread::sleep_for(std::chrono::milliseconds(110));  // a picture each 100 ms at most
    screen_->frame({.frame = frame_,
                    .sample = sample_,
                    .estimators = columns_,
                    .row = row_,
                    .scores = scores_,
                    .inference_us = 90.0});
    std::string text;
    std::array<char, 4096> part{};
    while (text.find(" us\n") == std::string::npos) {
      const ssize_t count = read(ends_[0], part.data(), part.size());
      if (count <= 0) break;
      text.append(part.data(), static_cast<std::size_t>(count));
    }
    return text;
  }

  std::vector<EstimatorColumn> columns_ = paper_columns;
  std::array<int, 2> ends_{-1, -1};
  std::unique_ptr<OutputWriter> output_;
  std::unique_ptr<LiveScreen> screen_;
  rig::RecordingProgress progress_;
  TimedFrame frame_;
  LabelledSample sample_;
  EstimateRow row_;
  live::LiveScores scores_;
};

volatile std::sig_atomic_t interrupts_seen = 0;

TEST_F(LiveTui, LeavesWhenQIsPressedAndSaysThatItDoes) {
  const int before = dup(STDIN_FILENO);
  int keys = -1, terminal = -1;
  ASSERT_EQ(openpty(&keys, &terminal, nullptr, nullptr, nullptr), 0);
  dup2(terminal, STDIN_FILENO);
  const auto handler = std::signal(SIGINT, [](int) { interrupts_seen = interrupts_seen + 1; });
  screen_ = make_live_tui(*output_, Colours::cube);
  EXPECT_THAT(drawn(), HasSubstr("(q leaves)"));
  EXPECT_EQ(interrupts_seen, 0);
  EXPECT_EQ(write(keys, "xq", 2), 2);
  EXPECT_THAT(drawn(), HasSubstr("q: leaving\n"));
  EXPECT_EQ(interrupts_seen, 1);
  screen_.reset();
  std::signal(SIGINT, handler);
  dup2(before, STDIN_FILENO);
  for (const int end : {before, keys, terminal}) close(end);
}

TEST_F(LiveTui, ShowsTheLegAndAllRatesWithTheirErrors) {
  const std::string text = drawn();
  EXPECT_THAT(text, HasSubstr("leg 3 of 8"));
  EXPECT_THAT(text, HasSubstr("servo         +90.0 deg/s\n"));
  EXPECT_THAT(text, HasSubstr("gyro          +94.5  error    +4.5"));
  EXPECT_THAT(text, HasSubstr("cnn-thermal   +88.0  error    -2.0"));
  EXPECT_THAT(text, HasSubstr("cnn-fusion    +91.0  error    +1.0"));
  EXPECT_THAT(text, HasSubstr("Kg 0.25"));
  EXPECT_THAT(text, HasSubstr("rates in deg/s, angles in deg"));
  EXPECT_THAT(text, Not(HasSubstr("waiting for")));
  EXPECT_THAT(text, Not(HasSubstr("excluded: ")));
}

TEST_F(LiveTui, StandsInColumnsWhateverTheNamesAre) {
  columns_[1].name = "thermal-likelihood";
  const std::string text = drawn();
  EXPECT_THAT(text, HasSubstr("servo                +90.0 deg/s\n"));
  EXPECT_THAT(text, HasSubstr("gyro                 +94.5  error"));
  EXPECT_THAT(text, HasSubstr("thermal-likelihood   +88.0  error"));
}

TEST_F(LiveTui, SaysTheAngleOfAnEstimateOrWhyItIsNotTrusted) {
  RateEstimate& estimate = row_.estimates[0];
  estimate = {
      .rate_dps = 91.0F, .angle_deg = -123.44, .angle_sigma_deg = 0.26F, .state = EstimateState::good};
  EXPECT_THAT(drawn(), HasSubstr("  angle -123.4 +- 0.3\n"));
  estimate.state = EstimateState::relocalising;
  const std::string text = drawn();
  EXPECT_THAT(text, HasSubstr("  relocalising\n"));
  EXPECT_THAT(text, Not(HasSubstr("  angle")));
  estimate.state = EstimateState::not_trusted;
  estimate.reason = EstimateReason::view_differs;
  EXPECT_THAT(drawn(), HasSubstr("  view_differs\n"));
}

TEST_F(LiveTui, SaysWhatIsWaitedForAndForHowLong) {
  progress_.awaited[Device::servo] = rig::AwaitedDevice{.why = "unplugged", .waited_s = 48.0, .left_s = 12.0};
  EXPECT_THAT(drawn(), HasSubstr(", waiting for the servo (12.0 s left)"));
  progress_.awaited[Device::servo].reset();
  EXPECT_THAT(drawn(), Not(HasSubstr("waiting for"))) << "it is back";
}

TEST_F(LiveTui, SaysWhatIsGoneAndWhatIsThereforeUnknown) {
  progress_.gone[Device::gyro] = true;
  gyro_dps(row_) = fusion_dps(row_) = kg(row_) = nan;
  const std::string text = drawn();
  EXPECT_THAT(text, HasSubstr(", no gyro"));
  EXPECT_THAT(text, Not(HasSubstr("no camera")));
  EXPECT_THAT(text, HasSubstr("gyro              -  error       -"));
  EXPECT_THAT(text, HasSubstr("cnn-fusion        -  error       -"));
  EXPECT_THAT(text, HasSubstr("Kg -"));
}

TEST_F(LiveTui, ASessionsNamesDoNotSteerTheTerminal) {
  LiveFacts facts;
  facts.header.simulated = true;
  facts.plan_name = facts.header.simulation = facts.header.live_model.name =
      "tidy\x1b]0;title\x07\xc2\x9b"
      "2J";
  screen_->hello(facts);
  screen_->note("said\x1b[2J");
  const std::string text = drawn();
  EXPECT_THAT(text, HasSubstr("plan tidy\\u{1B}]0;title\\u{07}\\u{9B}2J"));
  for (const char* part : {"\x1b[2J", "\x1b]", "\x07", "\xc2\x9b"}) EXPECT_THAT(text, Not(HasSubstr(part)));
}

TEST_F(LiveTui, SaysWhyAFrameIsExcluded) {
  row_.counted = false;
  EXPECT_THAT(drawn(), HasSubstr("  excluded: ")) << "its window begins in another run";
}

TEST_F(LiveTui, DrawsOverThePictureBefore) {
  const std::string first = drawn();
  EXPECT_THAT(first, Not(HasSubstr("A\x1b[J")));
  const auto lines = std::count(first.begin(), first.end(), '\n');
  EXPECT_THAT(drawn(), HasSubstr("\x1b[" + std::to_string(lines) + "A\x1b[J"));
}

TEST_F(LiveTui, KeepsANoteAboveThePicture) {
  drawn();
  screen_->note("the servo's watchdog tripped\x1b[2J");
  const std::string text = drawn();
  EXPECT_THAT(text, HasSubstr("the servo's watchdog tripped\\u{1B}[2J\n"));
  EXPECT_LT(text.find("watchdog"), text.find("servo  "));
  EXPECT_EQ(text.find("A\x1b[J", text.find("watchdog")), std::string::npos) << "it is not drawn over";
}

}  // namespace
}  // namespace thermorig::app
