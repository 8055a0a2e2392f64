// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <algorithm>
#include <random>

#include "bench.h"

namespace thermorig::firmware_test {
namespace {

class ServoLink : public FirmwareTest {};

const servo_run slow_run{7, 0, 2000, 2000, 5000};

TEST_P(ServoLink, SpeaksFirstAfterAReset) {
  bench().run_for(100'000);
  ASSERT_EQ(bench().events().size(), 1U);
  EXPECT_EQ(bench().events()[0].kind, SERVO_EVENT_RESET);
  EXPECT_GE(bench().telemetry().size(), 9U);
  EXPECT_EQ(bench().now().motion, SERVO_MOTION_DISARMED);
  EXPECT_EQ(bench().damaged, 0);
}

TEST_P(ServoLink, WelcomeStatesVersionBoardAndLimits) {
  const Message welcome = bench().hello();
  ASSERT_EQ(welcome.type, SERVO_WELCOME);
  ASSERT_EQ(welcome.payload.size(), SERVO_WELCOME_SIZE);
  EXPECT_EQ(welcome.payload[0], SERVO_LINK_VERSION);
  EXPECT_EQ(welcome.payload[4], is_avr() ? SERVO_BOARD_ATMEGA328P : SERVO_BOARD_HOST);
  EXPECT_EQ(servo_get_u16(&welcome.payload[10]), SERVO_LIMIT_PULSE_MIN_US);
  EXPECT_EQ(servo_get_u32(&welcome.payload[14]), static_cast<std::uint32_t>(SERVO_LIMIT_RATE_CDPS));
  EXPECT_EQ(servo_get_u16(&welcome.payload[20]), SERVO_WATCHDOG_MS);
}

TEST_P(ServoLink, RefusesEveryCommandOfAnotherVersionAndNamesItsOwn) {
  EXPECT_EQ(bench().hello(SERVO_LINK_VERSION + 1).payload[0], SERVO_LINK_VERSION);
  const Message answer = bench().command(SERVO_CONFIGURE, payload_of(winch()));
  EXPECT_EQ(reason(answer), SERVO_REASON_WRONG_VERSION);
  EXPECT_EQ(answer.payload[2], SERVO_LINK_VERSION);
}

TEST_P(ServoLink, RefusesCommandsBeforeHello) {
  EXPECT_EQ(reason(bench().command(SERVO_CONFIGURE, payload_of(winch()))), SERVO_REASON_WRONG_VERSION);
  EXPECT_EQ(reason(bench().command(SERVO_PING, payload_of(servo_ping{1, 0}))), SERVO_REASON_WRONG_VERSION);
}

TEST_P(ServoLink, AcceptsALongerHelloOfALaterVersion) {
  EXPECT_EQ(bench().answer_to(frame(SERVO_HELLO, 9, {2, 3, 4})).value().type, SERVO_WELCOME);
}

TEST_P(ServoLink, ADuplicateIsAnsweredAgainAndMovesNothing) {
  bench().open(winch());
  const Bytes run = frame(SERVO_RUN, bench().next_sequence, payload_of(servo_run{3, 0, 10000, 20000, 200}));
  const auto first = bench().answer_to(run);
  bench().run_refreshed(400'000);
  const auto at_rest = bench().now();
  const auto second = bench().answer_to(run);
  bench().run_refreshed(400'000);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->type, SERVO_ACK);
  EXPECT_EQ(second->payload, first->payload);
  EXPECT_GT(at_rest.angle_cdeg, 1500);
  EXPECT_EQ(bench().now().angle_cdeg, at_rest.angle_cdeg);
  EXPECT_EQ(count(bench(), SERVO_EVENT_LEG_END, 3), 1);
}

TEST_P(ServoLink, ADuplicateOfARefusedCommandIsRefusedAgain) {
  bench().hello();
  const Bytes run = frame(SERVO_RUN, 1, payload_of(slow_run));
  const auto first = bench().answer_to(run);
  EXPECT_EQ(reason(first), SERVO_REASON_NOT_ARMED);
  EXPECT_EQ(bench().answer_to(run).value().payload, first.value().payload);
}

TEST_P(ServoLink, AnotherCommandUnderTheSameNumberIsNoDuplicate) {
  bench().open(winch());
  bench().command(SERVO_RUN, payload_of(servo_run{3, 0, 10000, 20000, 100}));
  const auto last = static_cast<std::uint8_t>(bench().next_sequence - 1);
  const auto answer =
      bench().answer_to(frame(SERVO_RUN, last, payload_of(servo_run{3, 0, -10000, 20000, 100})));
  EXPECT_EQ(reason(answer), SERVO_REASON_OUT_OF_SEQUENCE);
}

TEST_P(ServoLink, NamesTheSequenceNumberThatItExpects) {
  bench().open(winch());
  const std::uint8_t expected = bench().next_sequence;
  bench().next_sequence = static_cast<std::uint8_t>(expected + 5);
  const Message answer = bench().command(SERVO_RUN, payload_of(slow_run));
  EXPECT_EQ(reason(answer), SERVO_REASON_OUT_OF_SEQUENCE);
  EXPECT_EQ(answer.payload[2], expected);
  bench().next_sequence = expected;
  EXPECT_EQ(bench().command(SERVO_RUN, payload_of(slow_run)).type, SERVO_ACK);
}

TEST_P(ServoLink, SequenceNumbersWrap) {
  bench().hello();
  for (int i = 0; i < 300; ++i) EXPECT_EQ(bench().command(SERVO_DISARM).type, SERVO_ACK);
}

TEST_P(ServoLink, ARetryAfterADamagedCommandSucceeds) {
  bench().open(winch());
  Bytes run = frame(SERVO_RUN, bench().next_sequence, payload_of(slow_run));
  Bytes damaged = run;
  damaged[5] ^= 0x04;
  EXPECT_FALSE(bench().answer_to(damaged));
  EXPECT_EQ(bench().answer_to(run).value().type, SERVO_ACK);
}

TEST_P(ServoLink, SaysWhyItRefuses) {
  bench().hello();
  EXPECT_EQ(reason(bench().answer_to(frame(0x42, 1, {1, 2}))), SERVO_REASON_UNKNOWN_TYPE);
  EXPECT_EQ(reason(bench().answer_to(frame(SERVO_RUN, 1, {1, 2}))), SERVO_REASON_WRONG_LENGTH);
  EXPECT_EQ(reason(bench().command(SERVO_ARM, payload_of(servo_arm{0}))), SERVO_REASON_NOT_CONFIGURED);
  EXPECT_EQ(reason(bench().command(SERVO_RUN, payload_of(slow_run))), SERVO_REASON_NOT_ARMED);
  EXPECT_EQ(reason(bench().command(SERVO_HALT)), SERVO_REASON_NOT_ARMED);
  bench().command(SERVO_CONFIGURE, payload_of(winch()));
  EXPECT_EQ(reason(bench().command(SERVO_ARM, payload_of(servo_arm{107801}))), SERVO_REASON_BEYOND_LIMIT);
  EXPECT_EQ(bench().command(SERVO_ARM, payload_of(servo_arm{0})).type, SERVO_ACK);
  EXPECT_EQ(reason(bench().command(SERVO_ARM, payload_of(servo_arm{0}))), SERVO_REASON_ARMED);
  EXPECT_EQ(reason(bench().command(SERVO_CONFIGURE, payload_of(winch()))), SERVO_REASON_ARMED);
}

TEST_P(ServoLink, RefusesMotionsBeyondLimitsOrWithoutSense) {
  bench().open(winch());
  const auto run = [&](servo_run asked) { return reason(bench().command(SERVO_RUN, payload_of(asked))); };
  const auto go_to = [&](servo_go_to asked) {
    return reason(bench().command(SERVO_GO_TO, payload_of(asked)));
  };
  EXPECT_EQ(run({1, 0, 30001, 2000, 100}), SERVO_REASON_BEYOND_LIMIT);
  EXPECT_EQ(run({1, 0, INT32_MIN, 2000, 100}), SERVO_REASON_BEYOND_LIMIT);
  EXPECT_EQ(run({1, 0, 2000, 20001, 100}), SERVO_REASON_BEYOND_LIMIT);
  EXPECT_EQ(run({1, 0, 2000, 99, 100}), SERVO_REASON_BEYOND_LIMIT);
  EXPECT_EQ(run({1, 0, 2000, 2000, 60001}), SERVO_REASON_BEYOND_LIMIT);
  EXPECT_EQ(run({1, 0, 2000, 0, 100}), SERVO_REASON_BAD_VALUE);
  EXPECT_EQ(run({1, 0, 2000, 2000, 0}), SERVO_REASON_BAD_VALUE);
  EXPECT_EQ(run({1, 2, 2000, 2000, 100}), SERVO_REASON_BAD_VALUE);
  EXPECT_EQ(go_to({107801, 2000, 2000}), SERVO_REASON_BEYOND_LIMIT);
  EXPECT_EQ(go_to({0, 0, 2000}), SERVO_REASON_BAD_VALUE);
  bench().run_for(50'000);
  EXPECT_EQ(bench().now().angle_cdeg, 0);
  EXPECT_EQ(bench().now().motion, SERVO_MOTION_HOLDING);
}

TEST_P(ServoLink, TheHostCanOnlyLowerLimits) {
  bench().hello();
  const auto configure = [&](auto change) {
    servo_configure asked = winch();
    change(asked);
    return reason(bench().command(SERVO_CONFIGURE, payload_of(asked)));
  };
  EXPECT_EQ(configure([](auto& c) { c.pulse_min_us = 499; }), SERVO_REASON_BEYOND_LIMIT);
  EXPECT_EQ(configure([](auto& c) { c.pulse_max_us = 2501; }), SERVO_REASON_BEYOND_LIMIT);
  EXPECT_EQ(configure([](auto& c) { c.limit_rate_cdps = 30001; }), SERVO_REASON_BEYOND_LIMIT);
  EXPECT_EQ(configure([](auto& c) { c.limit_acceleration_dps2 = 20001; }), SERVO_REASON_BEYOND_LIMIT);
  EXPECT_EQ(configure([](auto& c) { c.angle_max_cdeg = 108001; }), SERVO_REASON_BEYOND_LIMIT);
  EXPECT_EQ(configure([](auto& c) { c.span = 0xFFFFFFFF; }), SERVO_REASON_BEYOND_LIMIT);
  EXPECT_EQ(configure([](auto& c) { c.pulse_max_us = 500; }), SERVO_REASON_BAD_VALUE);
  EXPECT_EQ(configure([](auto& c) { c.kind = 2; }), SERVO_REASON_BAD_VALUE);
  EXPECT_EQ(configure([](auto& c) { c.angle_min_cdeg = c.angle_max_cdeg; }), SERVO_REASON_BAD_VALUE);
  EXPECT_EQ(configure([](auto& c) { c.limit_rate_cdps = 5000; }), 0);
  bench().command(SERVO_ARM, payload_of(servo_arm{0}));
  EXPECT_EQ(reason(bench().command(SERVO_RUN, payload_of(servo_run{1, 0, 5001, 2000, 100}))),
            SERVO_REASON_BEYOND_LIMIT);
  EXPECT_EQ(bench().command(SERVO_RUN, payload_of(servo_run{1, 0, 5000, 2000, 100})).type, SERVO_ACK);
}

TEST_P(ServoLink, IgnoresItsOwnMessages) {
  bench().hello();
  EXPECT_FALSE(bench().answer_to(frame(SERVO_TELEMETRY, 1, Bytes(SERVO_TELEMETRY_SIZE))));
}

TEST_P(ServoLink, TelemetryIsExactlyTenMillisecondsApart) {
  bench().open(winch());
  bench().command(SERVO_RUN, payload_of(servo_run{1, SERVO_RUN_TURN_BACK, 20000, 2000, 5000}));
  bench().run_refreshed(2'000'000);
  const auto& telemetry = bench().telemetry();
  ASSERT_GE(telemetry.size(), 200U);
  for (std::size_t i = 1; i < telemetry.size(); ++i) {
    EXPECT_EQ(telemetry[i].mcu_us - telemetry[i - 1].mcu_us, 10'000U);
    EXPECT_EQ(static_cast<std::uint8_t>(bench().telemetry_frames()[i - 1].sequence + 1),
              bench().telemetry_frames()[i].sequence);
  }
}

TEST_P(ServoLink, TheMicroControllersTimeIsRealTime) {
  bench().run_for(3'000'000);
  for (std::size_t i = 0; i < bench().telemetry().size(); ++i) {
    const auto age_us = bench().telemetry_frames()[i].time_us - std::int64_t{bench().telemetry()[i].mcu_us};
    EXPECT_GT(age_us, 0);
    EXPECT_LT(age_us, 3000);
  }
}

TEST_P(ServoLink, PongIsDelayedWithinWhatThePingAllowsAndSpreadsOverIt) {
  bench().hello();
  std::vector<std::int64_t> delays_us;
  for (std::uint32_t i = 0; i < 100; ++i) {
    const std::int64_t sent_us = bench().now_us();
    const Bytes ping = frame(SERVO_PING, 0, payload_of(servo_ping{1000 + i, 3000}));
    const auto pong = bench().answer_to(ping);
    ASSERT_TRUE(pong && pong->type == SERVO_PONG);
    EXPECT_EQ(servo_get_u32(&pong->payload[0]), 1000 + i);
    const std::int64_t receive_us = servo_get_u32(&pong->payload[4]),
                       send_us = servo_get_u32(&pong->payload[8]);
    const std::int64_t line_us = receive_us - sent_us - 40 * static_cast<std::int64_t>(ping.size());
    EXPECT_LT(std::abs(line_us), 250);  // the AVR's clock begins when its memory has been cleared
    delays_us.push_back(send_us - receive_us);
    bench().run_for(7'300);
  }
  const auto [least, most] = std::ranges::minmax(delays_us);
  EXPECT_GE(least, 0);
  EXPECT_LE(most, 3000 + 2500);  // the transmitter may be busy with telemetry and an event
  EXPECT_LT(least, 300);
  EXPECT_GT(most, 2700);
  std::ranges::sort(delays_us);
  const auto distinct = std::unique(delays_us.begin(), delays_us.end()) - delays_us.begin();
  EXPECT_GT(distinct, 80);
}

TEST_P(ServoLink, PongNamesTheInstantOfItsFirstByte) {
  bench().hello();
  for (int i = 0; i < 20; ++i) {
    const auto pong = bench().answer_to(frame(SERVO_PING, 0, payload_of(servo_ping{5, 2000})));
    ASSERT_TRUE(pong);
    const std::size_t size = frame(SERVO_PONG, 0, pong->payload).size();
    const double first_us = static_cast<double>(pong->time_us) - 40.0 * static_cast<double>(size - 1);
    // simavr takes 44 us a byte, and the AVR builds the frame behind its first byte.
    EXPECT_NEAR(servo_get_u32(&pong->payload[8]), first_us, is_avr() ? 700.0 : 50.0);
  }
}

TEST_P(ServoLink, RefusesAPingDelayBeyondItsMaximum) {
  bench().hello();
  EXPECT_EQ(reason(bench().answer_to(frame(SERVO_PING, 0, payload_of(servo_ping{1, 20001})))),
            SERVO_REASON_BEYOND_LIMIT);
}

TEST_P(ServoLink, GarbageNeverMovesIt) {
  bench().open(winch(), 1000);
  std::mt19937 random(4);
  for (int i = 0; i < 40; ++i) {
    Bytes garbage(100);
    for (auto& byte : garbage) byte = static_cast<std::uint8_t>(random());
    bench().send(garbage);
  }
  bench().send({SERVO_LINK_FLAG});
  bench().run_for(50'000);
  EXPECT_EQ(bench().now().angle_cdeg, 1000);
  EXPECT_EQ(bench().now().rate_cdps, 0);
}

TEST_P(ServoLink, FlippedBitsNeverMakeADifferentMotion) {
  bench().open(winch());
  const Bytes run = frame(SERVO_RUN, bench().next_sequence, payload_of(slow_run));
  for (std::size_t bit = 8; bit < 8 * (run.size() - 1); ++bit) {
    Bytes damaged = run;
    damaged[bit / 8] = static_cast<std::uint8_t>(damaged[bit / 8] ^ (1U << (bit % 8)));
    bench().send(damaged);
    bench().run_for(2'000);
  }
  bench().run_for(30'000);
  for (const servo_telemetry& telemetry : bench().telemetry()) EXPECT_EQ(telemetry.rate_cdps, 0);
}

INSTANTIATE_TEST_SUITE_P(Both, ServoLink, testing::Values(Form::host_build, Form::avr_image),
                         [](const auto& form) {
                           return form.param == Form::host_build ? "HostBuild" : "AvrImage";
                         });

}  // namespace
}  // namespace thermorig::firmware_test
