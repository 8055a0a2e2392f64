// SPDX-License-Identifier: MIT
#include "io/web/request_check.h"

#include <gtest/gtest.h>

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

}  // namespace thermorig::web
