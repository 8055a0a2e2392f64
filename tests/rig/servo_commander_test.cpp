// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/servo_commander.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "servo_link.h"
#include "thermorig/core/error.h"

namespace thermorig::rig {
namespace {

using ::testing::HasSubstr;

struct Heard {
  std::uint8_t type = 0;
  std::uint8_t sequence = 0;
  std::vector<std::uint8_t> payload;
};

/// The servo's ear: frames out of what the commander wants to be written.
std::vector<Heard> hear(const std::vector<std::uint8_t>& bytes) {
  std::vector<Heard> heard;
  servo_decoder decoder{};
  servo_decoder_reset(&decoder);
  for (const std::uint8_t byte : bytes) {
    const auto what = servo_decoder_push(&decoder, byte);
    if (what == SERVO_DECODED_STOP) heard.push_back({.type = SERVO_LINK_STOP});
    if (what != SERVO_DECODED_FRAME) continue;
    const std::uint8_t size = servo_decoder_payload_size(&decoder);
    heard.push_back({decoder.body[0], decoder.body[1], {decoder.body + 2, decoder.body + 2 + size}});
  }
  return heard;
}

/// A commander with a script instead of a servo.
class Conversation : public ::testing::Test {
 protected:
  std::vector<Heard> poll_after(int ms) {
    now_ += std::chrono::milliseconds(ms);
    auto heard = hear(commander_.poll(now_));
    std::erase_if(heard, [](const Heard& message) { return message.type == SERVO_PING; });
    return heard;
  }
  void answer(auto body, std::uint8_t sequence) {
    commander_.answer({.body = body, .sequence = sequence}, now_);
  }
  void acknowledge(const Heard& command) {
    answer(wire::ServoAck{.type = command.type, .mcu_us = 1}, command.sequence);
  }
  void refuse(const Heard& command, std::uint8_t reason, std::uint8_t detail = 0) {
    answer(wire::ServoNack{command.type, reason, detail}, command.sequence);
  }
  void greet() {
    commander_.greet();
    const auto hello = poll_after(1);
    answer(wire::ServoWelcome{.version = SERVO_LINK_VERSION, .firmware = "1.2.3"}, hello.at(0).sequence);
    while (!commander_.idle()) acknowledge(poll_after(1).at(0));
  }
  void arm() {
    commander_.arm(0.0);
    acknowledge(poll_after(1).at(0));
  }
  template <typename Action>
  Error error_of(Action action) {
    try {
      action();
    } catch (const Error& error) {
      return error;
    }
    return {ExitCode::ok, "nothing was thrown", "", ""};
  }

  HostTime now_ = host_time_ns(1'000'000'000);
  ServoProfile servo_;
  ServoCommander commander_{servo_};
};

TEST_F(Conversation, BeginsWithHelloAndConfiguresADisarmedServo) {
  commander_.greet();
  auto heard = poll_after(1);
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_EQ(heard[0].type, SERVO_HELLO);
  EXPECT_EQ(heard[0].payload, (std::vector<std::uint8_t>{SERVO_LINK_VERSION, SERVO_ASK_SHAFT}));
  const std::uint8_t sequence = heard[0].sequence;
  answer(wire::ServoWelcome{.version = SERVO_LINK_VERSION}, sequence);
  heard = poll_after(1);
  EXPECT_EQ(heard.at(0).type, SERVO_DISARM);
  EXPECT_EQ(heard.at(0).sequence, static_cast<std::uint8_t>(sequence + 1));
  acknowledge(heard[0]);
  heard = poll_after(1);
  EXPECT_EQ(heard.at(0).type, SERVO_CONFIGURE);
  acknowledge(heard[0]);
  EXPECT_TRUE(commander_.idle());
  EXPECT_FALSE(commander_.armed());
}

TEST_F(Conversation, SaysReflashForAnotherVersion) {
  commander_.greet();
  const auto hello = poll_after(1).at(0);
  const Error error = error_of([&] { answer(wire::ServoWelcome{.version = 7}, hello.sequence); });
  EXPECT_EQ(error.code(), ExitCode::device_missing);
  EXPECT_THAT(error.what(), HasSubstr("version 7"));
  EXPECT_THAT(error.what(), HasSubstr("version 1"));
  EXPECT_THAT(error.what(), HasSubstr("reflash"));
  const Error nacked = error_of([&] { refuse(hello, SERVO_REASON_WRONG_VERSION, 9); });
  EXPECT_THAT(nacked.what(), HasSubstr("version 9"));
}

TEST_F(Conversation, SendsTheSameBytesAgainUntilTheyAreAcknowledged) {
  greet();
  commander_.arm(0.0);
  const auto first = poll_after(1);
  EXPECT_TRUE(poll_after(79).empty());
  const auto second = poll_after(1);
  ASSERT_EQ(second.size(), 1U);
  EXPECT_EQ(second[0].sequence, first.at(0).sequence);
  EXPECT_EQ(commander_.retries(), 1U);
  acknowledge(second[0]);
  acknowledge(first[0]);  // the late answer to the first try changes nothing
  EXPECT_TRUE(commander_.armed());
  EXPECT_TRUE(commander_.idle());
}

TEST_F(Conversation, OneCommandWaitsForTheOneBefore) {
  greet();
  commander_.arm(0.0);
  commander_.run({.leg = 1, .rate_dps = 20.0, .acceleration_dps2 = 2000.0, .duration_s = 1.0});
  const auto arm = poll_after(1);
  ASSERT_EQ(arm.size(), 1U);
  EXPECT_EQ(arm[0].type, SERVO_ARM);
  answer(wire::ServoAck{.type = SERVO_RUN}, arm[0].sequence);  // of another type
  answer(wire::ServoAck{.type = SERVO_ARM},
         static_cast<std::uint8_t>(arm[0].sequence + 1));  // of another number
  EXPECT_FALSE(commander_.armed());
  acknowledge(arm[0]);
  EXPECT_EQ(poll_after(1).at(0).type, SERVO_RUN);
}

TEST_F(Conversation, SequenceNumbersWrap) {
  greet();
  std::uint8_t last = 0;
  for (int i = 0; i < 600; ++i) {
    commander_.halt();
    const auto heard = poll_after(1);
    ASSERT_EQ(heard.at(0).type, SERVO_HALT);
    if (i > 0) {
      ASSERT_EQ(heard[0].sequence, static_cast<std::uint8_t>(last + 1));
    }
    last = heard[0].sequence;
    acknowledge(heard[0]);
  }
}

TEST_F(Conversation, FeedsTheWatchdogWhileArmed) {
  greet();
  EXPECT_TRUE(poll_after(100).empty());
  arm();
  int refreshes = 0;
  int silent = 0;
  for (int i = 0; i < 100; ++i) {
    now_ += std::chrono::milliseconds(10);
    const auto heard = hear(commander_.poll(now_));
    for (const Heard& message : heard) refreshes += message.type == SERVO_REFRESH;
    silent = heard.empty() ? silent + 1 : 0;
    EXPECT_LE(silent, 3);  // one each 40 ms, where no ping feeds it
  }
  EXPECT_GE(refreshes, 10);
  EXPECT_LE(refreshes, 25);
}

TEST_F(Conversation, PingsAtIrregularIntervals) {
  greet();
  std::vector<double> gaps_ms;
  HostTime last{};
  for (int i = 0; i < 20000; ++i) {
    now_ += std::chrono::milliseconds(1);
    for (const Heard& heard : hear(commander_.poll(now_))) {
      if (heard.type != SERVO_PING) continue;
      EXPECT_EQ(servo_get_u16(heard.payload.data() + 4), 3000U);
      if (last != HostTime{}) gaps_ms.push_back(1e3 * to_s(now_ - last));
      last = now_;
    }
  }
  ASSERT_GT(gaps_ms.size(), 30U);
  EXPECT_GE(*std::min_element(gaps_ms.begin(), gaps_ms.end()), 70.0);
  EXPECT_LE(*std::max_element(gaps_ms.begin(), gaps_ms.end()), 131.0);
  EXPECT_GT(
      *std::max_element(gaps_ms.begin(), gaps_ms.end()) - *std::min_element(gaps_ms.begin(), gaps_ms.end()),
      20.0);
}

TEST_F(Conversation, LengthensThePingsBehindALatencyTimer) {
  greet();
  std::vector<std::uint16_t> delays;
  for (int i = 0; i < 300; ++i) {
    now_ += std::chrono::milliseconds(10);
    for (const Heard& heard : hear(commander_.poll(now_))) {
      if (heard.type != SERVO_PING) continue;
      delays.push_back(servo_get_u16(heard.payload.data() + 4));
      const std::uint32_t token = servo_get_u32(heard.payload.data());
      commander_.pong({.token = token,
                       .receive_us = 100,
                       .send_us = 1100,
                       .arrival = now_ + std::chrono::milliseconds(15)});
    }
  }
  ASSERT_GE(delays.size(), 3U);
  EXPECT_EQ(delays.front(), 3000U);
  EXPECT_EQ(delays.back(), 20000U);
}

TEST_F(Conversation, GivesUpAServoThatIsSilent) {
  greet();
  commander_.arm(0.0);
  int sent = 0;
  const Error error = error_of([&] {
    for (int i = 0; i < 1000; ++i)
      for (const Heard& heard : poll_after(10)) sent += heard.type == SERVO_ARM;
  });
  EXPECT_EQ(error.code(), ExitCode::device_lost);
  EXPECT_EQ(sent, 6);
}

TEST_F(Conversation, SaysThatHelloWasNotAnswered) {
  commander_.greet();
  const Error error = error_of([&] {
    for (int i = 0; i < 2000; ++i) poll_after(10);
  });
  EXPECT_EQ(error.code(), ExitCode::device_missing);
  EXPECT_THAT(error.what(), HasSubstr("does not answer hello"));
}

TEST_F(Conversation, ExplainsARefusal) {
  greet();
  arm();
  commander_.run({.leg = 1, .rate_dps = 299.0, .acceleration_dps2 = 2000.0, .duration_s = 1.0});
  const auto run = poll_after(1).at(0);
  const Error error = error_of([&] { refuse(run, SERVO_REASON_BEYOND_LIMIT); });
  EXPECT_EQ(error.code(), ExitCode::bad_usage);
  EXPECT_THAT(error.what(), HasSubstr("limit"));
}

TEST_F(Conversation, NotesARefusalThatArmingMends) {
  greet();
  arm();
  commander_.halt();
  refuse(poll_after(1).at(0), SERVO_REASON_FAULT);
  EXPECT_EQ(commander_.refusal(), SERVO_REASON_FAULT);
  EXPECT_TRUE(commander_.idle());
  commander_.clear();
  EXPECT_FALSE(commander_.refusal());
}

TEST_F(Conversation, ConfiguresAgainWhileTheServoStillComesToRest) {
  commander_.greet();
  answer(wire::ServoWelcome{.version = SERVO_LINK_VERSION}, poll_after(1).at(0).sequence);
  acknowledge(poll_after(1).at(0));  // disarm
  const auto first = poll_after(1).at(0);
  refuse(first, SERVO_REASON_ARMED);
  const auto second = poll_after(1).at(0);
  EXPECT_EQ(second.type, SERVO_CONFIGURE);
  EXPECT_EQ(second.sequence, static_cast<std::uint8_t>(first.sequence + 1));
  acknowledge(second);
  EXPECT_TRUE(commander_.idle());
}

TEST_F(Conversation, NoticesThatTheBoardWasReset) {
  greet();
  EXPECT_FALSE(commander_.was_reset());
  answer(wire::ServoEvent{.kind = SERVO_EVENT_RESET}, 0);
  EXPECT_TRUE(commander_.was_reset());
  greet();
  EXPECT_FALSE(commander_.was_reset());
}

TEST_F(Conversation, StopByteComesFirstAndTheQueueIsForgotten) {
  greet();
  arm();
  commander_.run({.leg = 1, .rate_dps = 20.0, .acceleration_dps2 = 2000.0, .duration_s = 1.0});
  commander_.stop();
  commander_.halt();
  const auto heard = poll_after(1);
  ASSERT_EQ(heard.size(), 2U);
  EXPECT_EQ(heard[0].type, SERVO_LINK_STOP);
  EXPECT_EQ(heard[1].type, SERVO_HALT);
  EXPECT_NO_THROW(refuse(heard[1], SERVO_REASON_FAULT));
  EXPECT_TRUE(commander_.idle());
}

}  // namespace
}  // namespace thermorig::rig
