// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "io/web/request_check.h"

namespace thermorig::web {

namespace {

const Gate gate{8650, std::string(32, 'a'), false};
const std::string bearer = "Bearer " + gate.token;

RequestHead file() {
  return {"GET", "/", "127.0.0.1:8650"};
}

RequestHead order(std::string_view target = "/stop") {
  return {"POST", target, "localhost:8650", "http://localhost:8650", "application/json", bearer, false, true};
}

unsigned status(const RequestHead& head, const Gate& its_gate = gate) {
  const auto refusal = check(head, its_gate);
  return refusal ? refusal->status : 200;
}

}  // namespace

TEST(RequestCheck, LetsTheRightOnesPass) {
  EXPECT_EQ(status(file()), 200U);
  EXPECT_EQ(status(order()), 200U);
  EXPECT_EQ(status(order("/mark")), 200U);
  EXPECT_EQ(status(order("/start"), {8650, gate.token, true}), 200U);
  EXPECT_EQ(status({"GET", "/stream", "[::1]:8650", "http://[::1]:8650", {}, {}, true}), 200U);
}

TEST(RequestCheck, FindsTheFirstOfManyFaultsInItsOrder) {
  RequestHead head{"DELETE",     "/nothing",  "a.example", "http://a.example",
                   "text/plain", "Bearer no", false,       true};
  EXPECT_EQ(status(head), 403U);
  head.host = "127.0.0.1:8650";
  EXPECT_EQ(status(head), 404U);
  head.target = "/start";
  EXPECT_EQ(status(head), 405U);
  head.method = "POST";
  EXPECT_EQ(status(head), 403U);
  head.origin = "http://127.0.0.1:8650";
  EXPECT_EQ(status(head), 415U);
  head.content_type = "application/json; charset=utf-8";
  EXPECT_EQ(status(head), 401U);
  head.authorization = bearer;
  EXPECT_EQ(status(head), 403U);
  EXPECT_EQ(status(head, {8650, gate.token, true}), 200U);
}

TEST(RequestCheck, WantsOriginAndHostToBeTheSameName) {
  RequestHead head = order();
  head.origin = "http://127.0.0.1:8650";
  EXPECT_EQ(status(head), 403U);
  head.origin = "http://localhost:8650/";
  EXPECT_EQ(status(head), 403U);
  head.origin = "";
  EXPECT_EQ(status(head), 403U);
}

TEST(RequestCheck, RefusesAForeignOriginOfAnOrderAndOfAStream) {
  const RequestHead stream{"GET", "/stream", "localhost:8650", {}, {}, {}, true};
  for (RequestHead head : {order(), stream}) {
    for (const auto origin : {"http://a.example", "http://localhost:1", "https://localhost:8650", "null"}) {
      head.origin = origin;
      EXPECT_EQ(status(head), 403U) << origin;
    }
    head.origin = std::nullopt;
    EXPECT_EQ(status(head), 403U) << "no origin";
  }
}

TEST(RequestCheck, WantsTheTokenWholeAndWhereItBelongs) {
  RequestHead head = order();
  const std::string short_one = bearer.substr(0, bearer.size() - 1);
  for (const std::string& shown :
       {short_one + "b", short_one, bearer + "a", std::string("Bearer"), "Basic " + gate.token, gate.token}) {
    head.authorization = shown;
    EXPECT_EQ(status(head), 401U) << shown;
  }
  head.authorization = std::nullopt;
  EXPECT_EQ(status(head), 401U);
  const std::string target = "/stop?t=" + gate.token;
  head.target = target;
  EXPECT_EQ(status(head), 404U) << "it is no part of an address";
}

TEST(RequestCheck, KnowsNoOtherSpellingOfATarget) {
  RequestHead head = file();
  for (const auto target :
       {"/../etc/passwd", "/..", "//", "//etc/passwd", "/%2e%2e/etc/passwd", "/%2e", "/./", "/page.js/",
        "/page.js%00", "/..%2f..%2fetc/passwd", "/\\..\\etc", "/PAGE.JS", "/page.css;a", "/?a=1", "/page.js?",
        "http://127.0.0.1:8650/", "*", ""}) {
    head.target = target;
    EXPECT_EQ(status(head), 404U) << target;
  }
}

TEST(RequestCheck, TakesOrdersAsJsonAlone) {
  RequestHead head = order();
  for (const auto type : {"text/plain", "application/jsonp", "application/x-www-form-urlencoded", ""}) {
    head.content_type = type;
    EXPECT_EQ(status(head), 415U) << type;
  }
  head.content_type = std::nullopt;
  EXPECT_EQ(status(head), 415U);
}

TEST(RequestCheck, WantsAStreamToBeAWebSocket) {
  EXPECT_EQ(status({"GET", "/stream", "localhost:8650", "http://localhost:8650"}), 426U);
}

TEST(RequestCheck, SaysWhichMethodIsRight) {
  EXPECT_EQ(check({"TRACE", "/", "localhost:8650"}, gate)->allow, "GET, HEAD");
  EXPECT_EQ(check({"GET", "/stop", "localhost:8650"}, gate)->allow, "POST");
  EXPECT_EQ(check({"POST", "/stream", "localhost:8650"}, gate)->allow, "GET");
}

TEST(RequestCheck, TakesTheUsualPortForGranted) {
  RequestHead head = file();
  for (const auto host : {"localhost", "127.0.0.1:80", "[::1]"}) {
    head.host = host;
    EXPECT_EQ(status(head, {80, gate.token, false}), 200U) << host;
  }
}

TEST(RequestCheck, KnowsNoOtherSpellingOfAHost) {
  RequestHead head = file();
  for (const auto host :
       {"rig.example:80", "192.168.1.5:8650", "0.0.0.0:8650", "127.0.0.1:1", "127.0.0.1", "127.0.0.1:86500",
        "127.0.0.1.nip.example:8650", "localhost.a.example:8650", "user@127.0.0.1:8650", "LOCALHOST:8650",
        "localhost.:8650", "127.1:8650", "2130706433:8650", "[::ffff:127.0.0.1]:8650", "127.0.0.1:08650",
        " 127.0.0.1:8650", "127.0.0.1:8650 ", "127.0.0.1:8650,a.example", ""}) {
    head.host = host;
    EXPECT_EQ(status(head), 403U) << host;
  }
  head.host = std::nullopt;
  EXPECT_EQ(status(head), 403U);
}

TEST(RequestCheck, TakesABodyForAnOrderAlone) {
  RequestHead head = file();
  head.body = true;
  EXPECT_EQ(status(head), 400U);
}

TEST(RequestCheck, NeverAcceptsAnEmptyToken) {
  RequestHead head = order();
  head.authorization = "Bearer ";
  EXPECT_EQ(status(head, {8650, "", false}), 401U);
}

TEST(Token, IsOf128BitsAndNeverTheSame) {
  const std::string first = make_token();
  EXPECT_THAT(first, ::testing::MatchesRegex("[0-9a-f]{32}"));
  EXPECT_NE(first, make_token());
}

TEST(Token, IsComparedWhole) {
  EXPECT_TRUE(same_token(gate.token, gate.token));
  EXPECT_FALSE(same_token(gate.token, std::string(31, 'a') + "b"));
  EXPECT_FALSE(same_token("b" + std::string(31, 'a'), gate.token));
  EXPECT_FALSE(same_token(std::string(31, 'a'), gate.token));
  EXPECT_FALSE(same_token("", ""));
}

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
