// SPDX-License-Identifier: MIT
#include "print/reading_progress.h"

#include <gtest/gtest.h>

#include <string>

#include "print/terminal_width.h"

namespace thermorig::app {
namespace {

TEST(ReadingProgress, TellsHowLongTheRestWillTakeIfItIsAsSlowAsWhatWasRead) {
  EXPECT_EQ(reading_text("reading sessions", 10, 40, 20.0), "reading sessions: 10 of 40, 1 min 0 s left");
  EXPECT_EQ(reading_text("reading sessions", 1, 241, 10.0), "reading sessions: 1 of 241, 40 min 0 s left");
}

TEST(ReadingProgress, TellsNoTimeBeforeThereIsOneToGoBy) {
  EXPECT_EQ(reading_text("reading sessions", 0, 40, 20.0), "reading sessions: 0 of 40");
  EXPECT_EQ(reading_text("reading sessions", 3, 40, 0.9), "reading sessions: 3 of 40");
  EXPECT_EQ(reading_text("reading sessions", 40, 40, 80.0), "reading sessions: 40 of 40");
}

TEST(DrawnOver, IsNeverLongerThanALineOfTheTerminal) {
  const std::string clear = "\r\x1b[K", eighty(80, 'x');
  EXPECT_EQ(drawn_over("short", 80), clear + "short");
  EXPECT_EQ(drawn_over(eighty, 80), clear + eighty.substr(1)) << "a full line wraps";
  EXPECT_EQ(drawn_over(eighty, 200), clear + eighty);
  EXPECT_EQ(drawn_over("", 80), clear);
}

TEST(ReadingProgress, SaysNothingWithJson) {
  testing::internal::CaptureStdout();
  {
    ReadingProgress progress(true, ReadingProgress::Elsewhere::lines);
    progress(1, 2);
  }
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace thermorig::app
