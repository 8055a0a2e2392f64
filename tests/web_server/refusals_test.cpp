// SPDX-License-Identifier: MIT
// What a hostile page, another user or a broken client tries. Decision 9 has the same list.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>

#include "served_page.h"

namespace thermorig::web {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

class Refusals : public ServedPage {
 protected:
  /// Not a moment before its limit, and by twice of it: when exactly it began to count cannot be seen.
  void expect_closed_after(std::chrono::nanoseconds limit, PageClient& client) {
    clock_.advance(limit - 1ms);
    EXPECT_FALSE(client.is_closed(300ms)) << "it has time until then";
    clock_.advance(limit);
    EXPECT_TRUE(client.is_closed());
  }
};

// --- who asks ---------------------------------------------------------------------------------------------

// Which heads and bodies are refused is in tests/web: request_check_test.cpp and client_json_test.cpp.

TEST_F(Refusals, WhatTheChecksRefuseIsAnsweredAndNothingIsOrdered) {
  const std::string rest = json_type() + authorization();
  EXPECT_EQ(get_with_host("rig.example:80").status, 403);
  EXPECT_EQ(reply_to("GET / HTTP/1.1\r\n\r\n").status, 403) << "no host";
  EXPECT_EQ(stop_with("Origin: http://a.example\r\n" + rest).status, 403);
  EXPECT_EQ(stop_with(own_origin() + json_type()).status, 401) << "no token";
  EXPECT_EQ(connect().post("/stop", token().substr(1), "{}").status, 401);
  EXPECT_EQ(stop_with(own_origin() + authorization()).status, 415) << "no type of content";
  EXPECT_EQ(connect().post("/mark", token(), R"({"note":7})").status, 400);
  EXPECT_EQ(connect().get("/../etc/passwd").status, 404);
  EXPECT_EQ(connect().upgrade("").status, 403) << "a stream without an origin";
  EXPECT_TRUE(orders().empty());
}

TEST_F(Refusals, AFieldThatComesTwiceIsNone) {
  EXPECT_EQ(reply_to(fmt::format("GET / HTTP/1.1\r\nHost: {0}\r\nHost: {0}\r\n\r\n", host())).status, 403);
  const std::string rest = own_origin() + json_type() + authorization();
  EXPECT_EQ(stop_with("Origin: http://a.example\r\n" + rest).status, 403);
  EXPECT_TRUE(orders().empty());
}

// --- the token --------------------------------------------------------------------------------------------

TEST_F(Refusals, AWrongTokenClosesTheStream) {
  PageClient client = open_stream(server().port(), std::string(32, '0'));
  EXPECT_EQ(client.receive().close_code, 1008);
  EXPECT_EQ(server().clients(), 0U);
}

TEST_F(Refusals, ABinaryFirstMessageClosesTheStream) {
  PageClient client = connect();
  ASSERT_EQ(client.upgrade().status, 101);
  client.send_frame(2, fmt::format(R"({{"token":"{}"}})", token()));
  EXPECT_EQ(client.receive().close_code, 1003);
}

TEST_F(Refusals, AnOversizedFirstMessageClosesTheStream) {
  PageClient client = connect();
  ASSERT_EQ(client.upgrade().status, 101);
  client.send_text(std::string(5000, ' '));
  EXPECT_EQ(client.receive().close_code, 1009);
}

TEST_F(Refusals, ASecondMessageClosesTheStream) {
  PageClient client = open_stream(server().port(), token());
  client.send_text("{}");
  EXPECT_EQ(client.receive().close_code, 1008);
}

TEST_F(Refusals, AStreamThatIsSlowWithItsTokenIsClosed) {
  PageClient client = connect();
  ASSERT_EQ(client.upgrade().status, 101);
  clock_.advance(options_.token_time - 1ms);
  EXPECT_EQ(client.receive(300ms).kind, Arrival::Kind::silence) << "it has time until then";
  clock_.advance(1ms);
  EXPECT_TRUE(client.is_closed());
}

TEST_F(Refusals, AStreamThatDoesNotSayGoodbyeIsClosed) {
  PageClient client = open_stream(server().port(), token());
  ASSERT_TRUE(comes_true([&] { return server().clients() == 1; }));
  client.send_text("one message too many");
  EXPECT_TRUE(clock_.advance_until([&] { return server().clients() == 0; }, 1s));
}

// --- sizes and times --------------------------------------------------------------------------------------

TEST_F(Refusals, AnOversizedRequestLineIsRefused) {
  EXPECT_EQ(connect().get("/" + std::string(9'000, 'a')).status, 414);
}

TEST_F(Refusals, OversizedHeadersAreRefused) {
  EXPECT_EQ(connect().get("/", "X-A: " + std::string(20'000, 'a') + "\r\n").status, 431);
  std::string many;
  for (int i = 0; i < 2'000; ++i) many += fmt::format("X-{}: a\r\n", i);
  EXPECT_EQ(connect().get("/", many).status, 431);
}

TEST_F(Refusals, AnOversizedBodyIsRefused) {
  EXPECT_EQ(connect().post("/mark", token(), std::string(70'000, ' ')).status, 413);
  EXPECT_TRUE(orders().empty());
}

TEST_F(Refusals, HeadersThatDripEndTheConnection) {
  PageClient client = connect();
  client.send("GET / HTTP/1.1\r\n");
  bool closed = false;
  for (int drop = 0; drop < 12 && !closed; ++drop) {  // three times of what all of them have
    client.send("X: a\r\n");
    clock_.advance(options_.header_time / 4);
    closed = client.is_closed(300ms);
  }
  EXPECT_TRUE(closed || client.is_closed());
}

TEST_F(Refusals, ASlowBodyEndsTheConnection) {
  PageClient client = connect();
  client.send("POST /stop HTTP/1.1\r\nHost: " + host() + "\r\n" + own_origin() + json_type() +
              authorization() + "Content-Length: 2\r\n\r\n{");
  expect_closed_after(options_.header_time, client);
  EXPECT_TRUE(orders().empty());
}

// --- what is asked ----------------------------------------------------------------------------------------

TEST_F(Refusals, AWebSocketOfAnotherVersionOrWithoutAKeyIsRefusedAsEverythingElse) {
  const std::string fields = own_origin() + "Connection: Upgrade\r\nUpgrade: websocket\r\n";
  const std::string key = "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
  for (const std::string& rest :
       {key + "Sec-WebSocket-Version: 8\r\n", key, std::string("Sec-WebSocket-Version: 13\r\n"),
        std::string("Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: short\r\n"),
        key + key + "Sec-WebSocket-Version: 13\r\n"}) {
    const auto reply = connect().get("/stream", fields + rest);
    EXPECT_EQ(reply.status, 426) << rest;
    EXPECT_THAT(reply.body, HasSubstr("{\"error\":")) << rest;
    EXPECT_EQ(reply.field("Sec-WebSocket-Version"), "13") << rest;
    EXPECT_EQ(reply.field("Content-Security-Policy").substr(0, 18), "default-src 'self'") << rest;
  }
}

TEST_F(Refusals, PipelinedGarbageEndsTheConnection) {
  PageClient client = connect();
  client.send(fmt::format("GET /page.css HTTP/1.1\r\nHost: {}\r\n\r\n\x01\x02 garbage\r\n\r\n", host()));
  EXPECT_EQ(client.reply().status, 200);
  EXPECT_EQ(client.reply().status, 400);
  EXPECT_TRUE(client.is_closed());
}

TEST_F(Refusals, WhatIsNoHttpIsRefused) {
  EXPECT_EQ(reply_to("\x16\x03\x01\x02\x01\x01 a TLS client hello\r\n\r\n").status, 400);
  EXPECT_EQ(reply_to("GET / HTTP/9.9\r\n\r\n").status, 400);
}

TEST_F(Refusals, AChunkedBodyIsRefused) {
  EXPECT_EQ(reply_to("POST /stop HTTP/1.1\r\nHost: " + host() + "\r\n" + own_origin() + json_type() +
                     authorization() + "Transfer-Encoding: chunked\r\n\r\n2\r\n{}\r\n0\r\n\r\n")
                .status,
            411);
  EXPECT_TRUE(orders().empty());
}

TEST_F(Refusals, ConflictingLengthsAreRefused) {
  const std::string fields = own_origin() + json_type() + authorization();
  EXPECT_EQ(stop_with(fields + "Transfer-Encoding: chunked\r\n", "0\r\n\r\n").status, 400);
  EXPECT_EQ(stop_with(fields + "Content-Length: 0\r\n").status, 400);
  EXPECT_EQ(stop_with(fields + "Content-Length: -1\r\n").status, 400);
  EXPECT_TRUE(orders().empty());
}

TEST_F(Refusals, ARequestHiddenInABodyIsNotServed) {
  const std::string hidden = fmt::format("GET /page.css HTTP/1.1\r\nHost: {}\r\n\r\n", host());
  PageClient client = connect();
  client.send(fmt::format("GET / HTTP/1.1\r\nHost: {}\r\nContent-Length: {}\r\n\r\n{}", host(), hidden.size(),
                          hidden));
  EXPECT_EQ(client.reply().status, 400);
  EXPECT_TRUE(client.is_closed());
}

// --- how many ---------------------------------------------------------------------------------------------

TEST_F(Refusals, TheNinthClientIsRefusedWithASentence) {
  std::vector<PageClient> open;
  for (int i = 0; i < 8; ++i) open.push_back(open_stream(server().port(), token()));
  ASSERT_TRUE(comes_true([&] { return server().clients() == 8; }));
  const auto reply = connect().upgrade();
  EXPECT_EQ(reply.status, 503);
  EXPECT_THAT(reply.body, HasSubstr("8 pages are open already"));
  open.pop_back();
  ASSERT_TRUE(comes_true([&] { return server().clients() == 7; }));
  EXPECT_EQ(connect().upgrade().status, 101);
}

TEST_F(Refusals, TooManyMarksAreRefusedWithTheLimitAndAStopNeverIs) {
  options_.marks = 3;
  options_.mark_period = 1h;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(connect().post("/mark", token(), "{}").status, 204);
  const auto reply = connect().post("/mark", token(), R"({"note":"one too many"})");
  EXPECT_EQ(reply.status, 429);
  EXPECT_THAT(reply.body, HasSubstr("3 marks"));
  for (int i = 0; i < 10; ++i) EXPECT_EQ(connect().post("/stop", token(), "{}").status, 204);
  EXPECT_EQ(orders().size(), 13U);
}

}  // namespace thermorig::web
