// SPDX-License-Identifier: MIT
#include "thermorig/core/error.h"

#include <gtest/gtest.h>

namespace thermorig::test {
namespace {

TEST(Error, SaysWhatWhereAndWhatToTry) {
  const Error error(ExitCode::device_missing, "nothing was heard", "/dev/ttyUSB0", "check the cable");
  EXPECT_STREQ(error.what(), "/dev/ttyUSB0: nothing was heard\n  try: check the cable");
  EXPECT_EQ(error.code(), ExitCode::device_missing);
  EXPECT_EQ(error.what_happened(), "nothing was heard");
  EXPECT_EQ(error.where(), "/dev/ttyUSB0");
  EXPECT_EQ(error.advice(), "check the cable");
}

TEST(Error, LeavesOutWhatIsNotKnown) {
  EXPECT_STREQ(Error(ExitCode::failed, "it broke", "", "").what(), "it broke");
}

}  // namespace
}  // namespace thermorig::test
