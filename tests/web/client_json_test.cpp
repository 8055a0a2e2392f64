// SPDX-License-Identifier: MIT
#include "io/web/client_json.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

namespace thermorig::web {

namespace {

const std::string a_token(32, 'a');

bool is_taken(std::string_view body, OrderKind kind = OrderKind::mark) {
  return std::holds_alternative<Order>(parse_order(kind, body));
}

}  // namespace

TEST(ClientJson, TakesANoteAsItIs) {
  const auto order = parse_order(OrderKind::mark, R"({"note":"\u00e9t\u00e9 <b> & \"x\""})");
  ASSERT_TRUE(std::holds_alternative<Order>(order));
  EXPECT_EQ(std::get<Order>(order).note, "\u00e9t\u00e9 <b> & \"x\"");
}

TEST(ClientJson, StopsWithAnyObject) {
  EXPECT_TRUE(is_taken("{}", OrderKind::stop));
  EXPECT_TRUE(is_taken(R"({"why":"fast"})", OrderKind::stop));
  EXPECT_TRUE(is_taken(R"({"note":7})", OrderKind::stop));
  EXPECT_FALSE(is_taken("", OrderKind::stop));
}

TEST(ClientJson, RefusesEveryCharacterThatDoesNotPrint) {
  for (int character = 0; character < 0xa0; ++character) {
    const bool prints = character >= 0x20 && (character < 0x7f || character > 0x9f);
    EXPECT_EQ(is_taken(fmt::format(R"({{"note":"a\u{:04x}"}})", character)), prints) << character;
  }
  for (const int character : {0x00ad, 0x061c, 0x180e, 0x200b, 0x200f, 0x2028, 0x202a, 0x202e, 0x2060, 0x2066,
                              0x2069, 0x3164, 0xfe00, 0xfeff})
    EXPECT_FALSE(is_taken(fmt::format(R"({{"note":"\u{:04x}"}})", character))) << character;
  for (const int character : {0xa0, 0xb0, 0x200a, 0x2010, 0x2030, 0x4e00, 0xffe6})
    EXPECT_TRUE(is_taken(fmt::format(R"({{"note":"\u{:04x}"}})", character))) << character;
}

TEST(ClientJson, RefusesTagCharactersAndTakesEmojis) {
  EXPECT_FALSE(is_taken("{\"note\":\"stop\xf3\xa0\x81\x81\"}"));  // U+E0041, as bytes
  EXPECT_FALSE(is_taken(R"({"note":"stop\udb40\udc41"})"));       // and as an escape
  EXPECT_TRUE(is_taken(R"({"note":"\u2600\ufe0f \ud83c\udf27\ufe0f"})"));
}

TEST(ClientJson, RefusesWhatIsNoOrderAndALongNote) {
  for (const std::string_view body : {"", "{", "[]", "1", R"({"note":7})", "{\"note\":\"\x1b[2J\"}"})
    EXPECT_FALSE(is_taken(body)) << body;
  EXPECT_TRUE(is_taken(fmt::format(R"({{"note":"{:a>200}"}})", "")));
  EXPECT_FALSE(is_taken(fmt::format(R"({{"note":"{:a>201}"}})", "")));
}

TEST(ClientJson, RefusesWhatIsNotUtf8) {
  for (const std::string note : {"\xff", "\xc0\x80", "\xed\xa0\x80", "\xe2\x82", "\xf5\x80\x80\x80"})
    EXPECT_FALSE(is_taken("{\"note\":\"" + note + "\"}"));
  EXPECT_FALSE(is_taken(R"({"note":"\ud800"})"));
}

TEST(ClientJson, IsNotImpressedByDepth) {
  for (const std::string opening : {"[", "{\"a\":", "{\"note\":["}) {
    std::string deep;
    while (deep.size() < 60'000) deep += opening;
    EXPECT_FALSE(is_taken(deep));
    EXPECT_FALSE(shows_token(deep, a_token));
  }
}

TEST(ClientJson, RefusesWhateverIsNestedInAnObject) {
  for (const std::string_view body :
       {R"({"a":{}})", R"({"a":[]})", R"({"a":{"b":1}})", R"({"a":1,"b":[1]})"}) {
    EXPECT_FALSE(is_taken(body)) << body;
    EXPECT_FALSE(is_taken(body, OrderKind::stop)) << body;
  }
  EXPECT_FALSE(shows_token(R"({"a":{},"token":")" + a_token + "\"}", a_token));
  EXPECT_TRUE(is_taken(R"({"a":null,"b":"{}"})"));
}

TEST(ClientJson, KnowsItsTokenAlone) {
  EXPECT_TRUE(shows_token(R"({"token":")" + a_token + "\"}", a_token));
  EXPECT_FALSE(shows_token(R"({"token":")" + a_token + "a\"}", a_token));
  EXPECT_FALSE(shows_token(R"({"Token":")" + a_token + "\"}", a_token));
  EXPECT_FALSE(shows_token(R"(["token"])", a_token));
  EXPECT_FALSE(shows_token(R"({"token":""})", ""));
}

TEST(ClientJson, SurvivesEveryBytes) {
  std::mt19937 random(7);
  const std::string_view alphabet = "{}[]\":,\\u0note1.eE- \x01\xff\xc3\xa9tru";
  for (int i = 0; i < 20'000; ++i) {
    std::string body;
    for (auto length = random() % 24; length > 0; --length) body += alphabet[random() % alphabet.size()];
    (void)parse_order(OrderKind::mark, body);
    EXPECT_FALSE(shows_token(body, a_token));
  }
}

}  // namespace thermorig::web
