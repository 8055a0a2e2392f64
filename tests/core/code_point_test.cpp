// SPDX-License-Identifier: MIT
#include "thermorig/core/code_point.h"

#include <gtest/gtest.h>

namespace thermorig {

TEST(CodePoint, ControlsAreC0DeleteAndC1) {
  for (char32_t code_point = 0; code_point < 0x100; ++code_point)
    EXPECT_EQ(is_control(code_point), code_point < 0x20 || (code_point > 0x7e && code_point < 0xa0))
        << static_cast<unsigned>(code_point);
}

TEST(CodePoint, KnowsEachThatChangesTheDirection) {
  int changing = 0;
  for (char32_t code_point = 0; code_point <= 0x10ffff; ++code_point)
    if (changes_direction(code_point)) {
      ++changing;
      EXPECT_TRUE(is_invisible(code_point)) << static_cast<unsigned>(code_point);
    }
  EXPECT_EQ(changing, 12);  // as many as Unicode's Bidi_Control has
}

TEST(CodePoint, WhatDrawsNothingIsInvisible) {
  for (const char32_t code_point :
       {0xad, 0x34f, 0x61c, 0x1160, 0x180e, 0x200b, 0x200d, 0x2060, 0x2064, 0x206f, 0x3164, 0xfe00, 0xfeff,
        0xffa0, 0xfff9, 0x1d173, 0xe0001, 0xe0041, 0xe01ef})
    EXPECT_TRUE(is_invisible(code_point)) << static_cast<unsigned>(code_point);
}

TEST(CodePoint, BlanksLettersAndEmojisAreVisible) {
  for (const char32_t code_point : {0x20, 0x41, 0xa0, 0xb0, 0xe9, 0x301, 0x5d0, 0x627, 0x1100, 0x200a, 0x2010,
                                    0x202f, 0x3000, 0x4e00, 0xfe0f, 0xfffd, 0x1f327})
    EXPECT_TRUE(is_plain(code_point)) << static_cast<unsigned>(code_point);
}

TEST(CodePoint, PlainTextHasNoLineSeparators) {
  for (const char32_t code_point : {0x0a, 0x0d, 0x85, 0x2028, 0x2029})
    EXPECT_FALSE(is_plain(code_point)) << static_cast<unsigned>(code_point);
}

}  // namespace thermorig
