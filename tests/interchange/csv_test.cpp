// SPDX-License-Identifier: MIT
#include "thermorig/learning/interchange/formats.h"

#include <gtest/gtest.h>

#include <cmath>

#include "text_sink.h"

namespace thermorig::interchange {
namespace {

std::string csv_of(const std::string& text) {
  TextSink sink;
  write_csv({1, {{"note", "", 6, [text](std::size_t) { return Value(text); }}}}, sink);
  return sink.text;
}

TEST(Csv, QuotesWhatWouldBreakALineApart) {
  EXPECT_EQ(csv_of("the door opened"), "note\r\nthe door opened\r\n");
  EXPECT_EQ(csv_of("left, then right"), "note\r\n\"left, then right\"\r\n");
  EXPECT_EQ(csv_of("he said \"stop\""), "note\r\n\"he said \"\"stop\"\"\"\r\n");
  EXPECT_EQ(csv_of("one\ntwo"), "note\r\n\"one\ntwo\"\r\n");
}

TEST(Csv, KeepsTextFromBeingAFormula) {
  EXPECT_EQ(csv_of("=cmd()"), "note\r\n'=cmd()\r\n");
  EXPECT_EQ(csv_of("@here"), "note\r\n'@here\r\n");
  EXPECT_EQ(csv_of("1 = 1"), "note\r\n1 = 1\r\n");
  for (const char* text : {"+1", "-1", "\t=1", "\r=1", "  =1"})
    EXPECT_NE(csv_of(text).find(std::string("'") + text), std::string::npos) << text;
  // Where `;` separates for a spreadsheet, and where tabs do.
  for (const char* text : {";=1", "a;=1", "a\t=1"})
    EXPECT_EQ(csv_of(text), "note\r\n\"" + std::string(text) + "\"\r\n");
}

TEST(Csv, LeavesAnUnknownNumberEmptyAndShowsAllDigitsOfAKnownOne) {
  TextSink sink;
  const std::vector<float> rates{-0.1F, std::nanf(""), 16777216.0F};
  write_csv({3,
             {{"rate", "deg/s", 4, [&](std::size_t row) { return Value(rates[row]); }},
              {"leg", "", 1, [](std::size_t row) { return Value(static_cast<std::uint16_t>(row)); }}}},
            sink);
  EXPECT_EQ(sink.text, "rate [deg/s],leg\r\n-0.1,0\r\n,1\r\n16777216,2\r\n");
}

}  // namespace
}  // namespace thermorig::interchange
