// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/ping_ledger.h"

#include <gtest/gtest.h>

#include "thermorig/pipeline/timing/link_timing.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::pipeline {
namespace {

constexpr std::uint32_t baud = 250000;

double on_the_wire_s(std::size_t bytes) {
  return shortest_wire_time_s(bytes, baud);
}

HostTime at_ms(double ms) {
  return HostTime(from_s(1e-3 * ms));
}

TimedServo telemetry_at(std::int64_t mcu_time_us) {
  TimedServo servo;
  servo.mcu_time_us = mcu_time_us;
  servo.state.mcu_us = static_cast<std::uint32_t>(mcu_time_us);
  return servo;
}

TimedPong pong(std::uint32_t token, std::uint32_t receive_us, std::uint32_t send_us, double arrival_ms) {
  return {.token = token,
          .receive_us = receive_us,
          .send_us = send_us,
          .span = {0, 20},
          .arrival = at_ms(arrival_ms)};
}

TEST(PingLedger, BoundsTheServosClockFromBothSidesWithoutTheWireTimes) {
  PingLedger ledger(baud);
  const auto ping = wire::ping_bytes(7, 3000);
  ledger.sent(ping, at_ms(100));
  const auto exchange =
      ledger.exchange(pong(7, 5'000'500, 5'001'000, 105), telemetry_at(5'000'000), at_ms(104));
  ASSERT_TRUE(exchange);
  EXPECT_EQ(exchange->receive_us, 5'000'500);
  EXPECT_EQ(exchange->send_us, 5'001'000);
  EXPECT_EQ(exchange->not_before, at_ms(100) + from_s(on_the_wire_s(ping.size())));
  EXPECT_EQ(exchange->not_after, at_ms(104));
}

TEST(PingLedger, HoldsOverALineThatIsFasterThanItsBaudRate) {
  PingLedger ledger(baud);
  const auto ping = wire::ping_bytes(7, 3000);
  ledger.sent(ping, at_ms(100));
  const double through_s = wire_time_s(ping.size(), baud) / 1.02;
  EXPECT_LE(ledger.exchange(pong(7, 1, 2, 105), telemetry_at(0), at_ms(104))->not_before,
            at_ms(100) + from_s(through_s));
}

TEST(PingLedger, ABytePortHasNoWireTime) {
  PingLedger ledger(0);
  ledger.sent(wire::ping_bytes(7, 3000), at_ms(100));
  EXPECT_EQ(ledger.exchange(pong(7, 1, 2, 105), telemetry_at(0), at_ms(105))->not_before, at_ms(100));
}

TEST(PingLedger, CommandsInTheSameWriteGoOutBeforeThePing) {
  PingLedger ledger(baud);
  auto bytes = wire::refresh_bytes();
  const auto ping = wire::ping_bytes(7, 3000);
  bytes.insert(bytes.end(), ping.begin(), ping.end());
  ledger.sent(bytes, at_ms(100));
  const auto exchange = ledger.exchange(pong(7, 1, 2, 105), telemetry_at(0), at_ms(104));
  EXPECT_EQ(exchange->not_before, at_ms(100) + from_s(on_the_wire_s(bytes.size())));
}

TEST(PingLedger, UnwrapsAcrossTheEndOf32Bits) {
  PingLedger ledger(baud);
  ledger.sent(wire::ping_bytes(1, 3000), at_ms(100));
  const std::int64_t wrap = std::int64_t{1} << 32;
  const auto exchange =
      ledger.exchange(pong(1, 0xFFFFFF00U, 200, 105), telemetry_at(3 * wrap + 100), at_ms(104));
  EXPECT_EQ(exchange->receive_us, 3 * wrap - 256);
  EXPECT_EQ(exchange->send_us, 3 * wrap + 200);
}

TEST(PingLedger, ATokenThatIsUsedAgainMeansTheNewestPingBeforeItsAnswer) {
  PingLedger ledger(0);
  for (const double ms : {100.0, 60'100.0, 90'000.0}) ledger.sent(wire::ping_bytes(1, 3000), at_ms(ms));
  const auto exchange = ledger.exchange(pong(1, 1, 2, 60'105), telemetry_at(0), at_ms(60'104));
  ASSERT_TRUE(exchange);
  EXPECT_EQ(exchange->not_before, at_ms(60'100));
}

TEST(PingLedger, KnowsNoAnswerToAPingThatWasNotSent) {
  PingLedger ledger(0);
  ledger.sent(wire::ping_bytes(1, 3000), at_ms(100));
  EXPECT_FALSE(ledger.exchange(pong(2, 1, 2, 105), telemetry_at(0), at_ms(104)));
  EXPECT_FALSE(ledger.exchange(pong(1, 1, 2, 99), telemetry_at(0), at_ms(98)));
  ledger.sent(std::vector<std::uint8_t>(500, 0x7E), at_ms(101));
  EXPECT_TRUE(ledger.exchange(pong(1, 1, 2, 105), telemetry_at(0), at_ms(104)));
}

TEST(PingLedger, ForgetsPingsThatWereNeverAnswered) {
  PingLedger ledger(0);
  for (std::uint32_t token = 0; token <= PingLedger::remembered; ++token)
    ledger.sent(wire::ping_bytes(token, 3000), at_ms(token));
  EXPECT_FALSE(ledger.exchange(pong(0, 1, 2, 1e6), telemetry_at(0), at_ms(1e6)));
  EXPECT_TRUE(ledger.exchange(pong(1, 1, 2, 1e6), telemetry_at(0), at_ms(1e6)));
}

}  // namespace
}  // namespace thermorig::pipeline
