// SPDX-License-Identifier: MIT
#include "thermorig/core/printable.h"

#include <gtest/gtest.h>

namespace thermorig::test {
namespace {

using namespace std::string_literals;

TEST(Printable, LeavesTextOfAnyScriptAsItIs) {
  for (const char* text : {"", "garden_acq-01.h5", "C:\\n", "Gerät", "温度", "שלום", "🌡", "a\u00A0b"})
    EXPECT_EQ(printable(text), text);
}

TEST(Printable, NamesWhatWouldSteerATerminal) {
  EXPECT_EQ(printable("a\nb\x1b[2J"), "a\\nb\\u{1B}[2J");
  EXPECT_EQ(printable("\ta\r\0\x7f"s), "\\ta\\r\\u{00}\\u{7F}"s);
  EXPECT_EQ(printable("\u009B31m"), "\\u{9B}31m");
}

TEST(Printable, NamesWhatTurnsTheDirectionOrCannotBeSeen) {
  EXPECT_EQ(printable("CC-BY\u202E4.0"), "CC-BY\\u{202E}4.0");
  EXPECT_EQ(printable("a\u061C\u180E\u00ADb"), "a\\u{61C}\\u{180E}\\u{AD}b");
}

TEST(Printable, NamesBytesThatAreNoUtf8) {
  EXPECT_EQ(printable("\xFF"), "\\xFF");
  EXPECT_EQ(printable("a\xC3"), "a\\xC3");                           // cut short
  EXPECT_EQ(printable("\xC0\xAF"), "\\xC0\\xAF");                    // longer than it need be
  EXPECT_EQ(printable("\xED\xA0\x80"), "\\xED\\xA0\\x80");           // half a pair of UTF-16
  EXPECT_EQ(printable("\xF4\x90\x80\x80"), "\\xF4\\x90\\x80\\x80");  // beyond the last character
  EXPECT_EQ(printable("\x9B"
                      "31m"),
            "\\x9B31m");
}

TEST(Printable, TwiceGivesTheSameAsOnce) {
  const std::string once = printable("a\n\xFF\u202E");
  EXPECT_EQ(printable(once), once);
}

TEST(Shell, ReadsAWordOfAPrintedCommandAsItWasMeant) {
  for (const char* plain :
       {"recordings/garden/garden_acq-01_20261130T015933Z.h5", "../a-b@c.h5", "/dev/ttyUSB0"})
    EXPECT_EQ(shell_word(plain), plain);
  EXPECT_EQ(shell_word("my data/x.h5"), "'my data/x.h5'");
  EXPECT_EQ(shell_word("it's"), R"('it'\''s')");
  for (const char* steering : {"a;b", "$HOME", "a*b", "`ls`", "~", "a|b", "a&b", "(a)", "a\nb", ""})
    EXPECT_EQ(shell_word(steering), "'" + std::string(steering) + "'");
}

}  // namespace
}  // namespace thermorig::test
