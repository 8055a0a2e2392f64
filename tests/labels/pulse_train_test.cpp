// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/pulse_train.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "scripted_rig.h"

namespace thermorig::labels {
namespace {

/// The pulses behind telemetry of a servo of 200 degrees, 10 us a degree, with its own pulse grid.
std::vector<Pulse> pulses(
    const std::function<double(double)>& angle_deg,
    const std::function<bool(int)>& comes = [](int) { return true; }) {
  ServoProfile servo;
  servo.travel_deg = 200.0;
  PulseTrain train{PulseScale(servo), from_s(0.05)};
  std::vector<Pulse> found;
  for (int i = 0; i < 100; ++i) {
    if (!comes(i)) continue;
    TimedServo message;
    message.mcu_time_us = 10'000 * i;
    message.stamp.time = at_s(0.01 * i);
    message.state.motion = ServoMotion::steady;
    message.state.pulse_us = static_cast<float>(1500.0 + 10.0 * angle_deg(0.01 * ((i - 1) / 2 * 2 + 1)));
    train.add(message, found);
  }
  return found;
}

TEST(PulseTrain, FindsAPulseInEveryPeriodWhereTheWidthChanges) {
  const auto found = pulses([](double t) { return 50.0 * t; });
  ASSERT_GE(found.size(), 49U);
  for (std::size_t i = 5; i < found.size(); ++i) {  // the phase is known
    EXPECT_EQ(found[i].start_us - found[i - 1].start_us, PulseTrain::period_us);
    const double start_s = 1e-6 * static_cast<double>(found[i].start_us);
    EXPECT_NEAR(found[i].value, 50.0 * start_s, 1e-4);
    EXPECT_NEAR(seconds(found[i].end), start_s + 1e-6 * (1500.0 + 500.0 * start_s), 1e-8);
    EXPECT_FALSE(found[i].restart);
  }
}

TEST(PulseTrain, KnowsThePulsesBetweenTwoChanges) {
  const auto found = pulses([](double t) { return t < 0.2 ? 50.0 * t : 10.0; });
  EXPECT_GE(found.size(), 49U);
  EXPECT_EQ(found.back().value, 10.0);
}

TEST(PulseTrain, FillsInWhatALostMessageWouldHaveShown) {
  const auto found = pulses([](double t) { return 50.0 * t; }, [](int i) { return i < 40 || i > 43; });
  for (std::size_t i = 5; i < found.size(); ++i) {  // the phase is known
    EXPECT_EQ(found[i].start_us - found[i - 1].start_us, PulseTrain::period_us);
    EXPECT_NEAR(found[i].value, 5e-5 * static_cast<double>(found[i].start_us), 1e-4);
  }
}

TEST(PulseTrain, StartsAgainAfterAGap) {
  const auto found = pulses([](double t) { return 50.0 * t; }, [](int i) { return i < 40 || i > 60; });
  int restarts = 0;
  for (const Pulse& pulse : found) restarts += pulse.restart ? 1 : 0;
  EXPECT_EQ(restarts, 2);  // the very first, and after the gap
}

TEST(PulseTrain, TakesTheCommandWhereNoPulseIsReported) {
  PulseTrain train{PulseScale(ServoProfile{}), from_s(0.05)};
  std::vector<Pulse> found;
  TimedServo message;
  message.state.angle_deg = 12.5;
  train.add(message, found);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].value, 12.5);
}

/// As a Dynamixel sends them: counts of a 4096th of a turn, whole milliseconds, at no fixed times.
TEST(PulseTrain, TakesASteadyCommandOnEvenlyWhereAnglesAndTimesHaveSteps) {
  constexpr double rate_dps = 60.0, count_deg = 360.0 / 4096.0;
  PulseTrain train{PulseScale(ServoProfile{}), from_s(0.12)};
  std::vector<Pulse> found;
  double time_s = 0.0;
  for (const double step_s : {0.0201, 0.0227, 0.0214, 0.0455, 0.0206, 0.0219, 0.0233, 0.0208, 0.0224}) {
    time_s += step_s;
    TimedServo message;
    message.mcu_time_us = static_cast<std::int64_t>(std::floor(time_s * 1e3)) * 1000;
    message.state.angle_deg = std::floor(rate_dps * time_s / count_deg) * count_deg;
    message.state.rate_dps = rate_dps;
    train.add(message, found);
  }
  ASSERT_GT(found.size(), 30U);
  for (std::size_t i = 5; i < found.size(); ++i) {
    const double passed_s = 1e-6 * static_cast<double>(found[i].start_us - found[i - 5].start_us);
    EXPECT_NEAR((found[i].value - found[i - 5].value) / passed_s, rate_dps, 0.2) << i;
  }
}

/// As an STS3215 sends them: the shaft's own angle, which stands and jumps by two degrees.
TEST(PulseTrain, TakesAShaftThatSticksAndSlipsForNoOtherCommand) {
  constexpr double rate_dps = 20.0, jump_deg = 2.0, period_s = 0.024;
  PulseTrain train{PulseScale(ServoProfile{}), from_s(0.12)};
  std::vector<Pulse> found;
  for (int i = 0; i < 150; ++i) {
    TimedServo message;
    message.mcu_time_us = std::llround(1e6 * period_s * i);
    message.state = {.angle_deg = std::floor(rate_dps * period_s * i / jump_deg) * jump_deg,
                     .rate_dps = rate_dps,
                     .motion = ServoMotion::steady,
                     .is_measured = true};
    train.add(message, found);
  }
  constexpr std::size_t apart = 20;
  ASSERT_GT(found.size(), 500U);
  for (std::size_t i = apart; i < found.size(); ++i) {
    const double passed_s = 1e-6 * static_cast<double>(found[i].start_us - found[i - apart].start_us);
    EXPECT_NEAR((found[i].value - found[i - apart].value) / passed_s, rate_dps, 1.0) << i;
  }
}

TEST(PulseTrain, SurvivesAClockThatJumpsAndNumbersThatAreNone) {
  PulseTrain train{PulseScale(ServoProfile{}), from_s(0.05)};
  std::vector<Pulse> found;
  for (const std::int64_t time_us : {0LL, 9'000'000'000'000'000LL, -5LL, 10'000LL, 20'000LL, 20'000LL}) {
    TimedServo message;
    message.mcu_time_us = time_us;
    message.state.angle_deg = std::nan("");
    train.add(message, found);
  }
  EXPECT_LT(found.size(), 10U);
  for (const Pulse& pulse : found) EXPECT_TRUE(std::isfinite(pulse.value));
}

}  // namespace
}  // namespace thermorig::labels
