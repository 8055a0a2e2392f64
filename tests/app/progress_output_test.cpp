// SPDX-License-Identifier: MIT
#include "record/progress_output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "pipe.h"

namespace thermorig::app {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

rig::RecordingProgress at_the_first_leg() {
  rig::RecordingProgress progress;
  progress.sweep.phase = rig::SweepPhase::leg;
  progress.sweep.leg = 1;
  progress.sweep.leg_count = 4;
  progress.sweep.rate_dps = -40.0;
  progress.sweep.speeds = {{-80.0, 0, 8}, {-40.0, 3, 8}, {40.0, 8, 8}, {80.0, 9, 8}};
  return progress;
}

/// All that a recording's output writes of one progress and a note.
std::string shown(ProgressStyle style) {
  const tests::Pipe pipe;
  OutputOptions options = progress_output_options(style, true);
  options.descriptor = pipe.writer();
  OutputWriter writer(options);
  {
    const auto output = make_progress_output(writer, style);
    output->show(at_the_first_leg());
    output->note("the servo's watchdog tripped\x1b[2J");
  }
  writer.finish();
  return pipe.rest();
}

TEST(StatusLines, ShowHowManyValidFramesEachSpeedHas) {
  const std::vector<std::string> lines = status_lines(at_the_first_leg());
  EXPECT_THAT(lines, Contains(HasSubstr("-80 [.3 ##] +80 deg/s")));
  EXPECT_THAT(lines, Contains(HasSubstr("2 of 4 speeds done")));
}

TEST(StatusLines, SayNothingOfTimeLeftOnceTheSweepIsStopped) {
  rig::RecordingProgress progress = at_the_first_leg();
  progress.sweep.done_share = 0.07;
  progress.sweep.eta_s = 90.0;
  EXPECT_THAT(status_lines(progress), Contains(HasSubstr(" 7 %, 1 min 30 s left")));
  progress.sweep.phase = rig::SweepPhase::stopping;
  progress.sweep.eta_s = 0.0;
  EXPECT_THAT(status_lines(progress), Not(Contains(HasSubstr("left"))));
}

TEST(ProgressOutput, DrawsOverItsLinesOnATerminal) {
  const std::string lines = std::to_string(status_lines(at_the_first_leg()).size());
  const std::string text = shown(ProgressStyle::terminal);
  EXPECT_THAT(text, HasSubstr("camera  nothing yet\n"));
  EXPECT_THAT(text, HasSubstr("\r\x1b[" + lines + "A\x1b[Jthe servo's watchdog tripped\\u{1B}[2J\n"));
}

TEST(ProgressOutput, WritesNoEscapeCodeElsewhere) {
  for (const ProgressStyle style : {ProgressStyle::lines, ProgressStyle::json}) {
    const std::string text = shown(style);
    EXPECT_THAT(text, HasSubstr("watchdog"));
    EXPECT_THAT(text, Not(HasSubstr("\x1b")));
  }
}

}  // namespace
}  // namespace thermorig::app
