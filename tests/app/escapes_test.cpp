// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "print/output.h"

namespace thermorig::app {
namespace {

TEST(EscapesAllowed, OnATerminalUnlessTheUserSaysOtherwise) {
  EXPECT_TRUE(escapes_allowed(true, nullptr, "xterm"));
  EXPECT_TRUE(escapes_allowed(true, nullptr, nullptr));
  EXPECT_TRUE(escapes_allowed(true, "", "xterm")) << "an empty NO_COLOR is none";
  EXPECT_FALSE(escapes_allowed(true, "1", "xterm"));
  EXPECT_FALSE(escapes_allowed(true, nullptr, "dumb"));
}

TEST(EscapesAllowed, NowhereElse) {
  EXPECT_FALSE(escapes_allowed(false, nullptr, "xterm"));
}

}  // namespace
}  // namespace thermorig::app
