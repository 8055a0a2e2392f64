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
       {"LOCALHOST:8650", "localhost.:8650", "127.1:8650", "2130706433:8650", "[::ffff:127.0.0.1]:8650",
        "127.0.0.1:08650", " 127.0.0.1:8650", "127.0.0.1:8650 ", "127.0.0.1:8650,a.example", ""}) {
    head.host = host;
    EXPECT_EQ(status(head), 403U) << host;
  }
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
