// SPDX-License-Identifier: MIT
// The motion law itself, step by step.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "bench.h"

extern "C" {
#include "../../firmware_servo/motion.h"
#include "../../firmware_servo/pulse.h"
}

namespace thermorig::firmware_test {
namespace {

constexpr std::int64_t udeg_per_cdeg = MOTION_UDEG_PER_CDEG;

std::int64_t angle_udeg(const motion& law) {
  return law.angle_cdeg * udeg_per_cdeg + law.angle_udeg;
}

void command_at_random(motion& law, std::mt19937& random, int acceleration_limit) {
  const auto between = [&](int low, int high) { return std::uniform_int_distribution(low, high)(random); };
  const auto acceleration = static_cast<std::uint16_t>(between(100, acceleration_limit));
  const auto turn_back = static_cast<std::uint8_t>(between(0, 1));
  const servo_run run{1, turn_back, between(-30000, 30000), acceleration,
                      static_cast<std::uint32_t>(between(1, 4000))};
  const servo_go_to go_to{between(law.low_cdeg, law.high_cdeg), static_cast<std::uint32_t>(between(1, 30000)),
                          acceleration};
  const int kind = between(0, 9);
  if (kind < 5) motion_run(&law, &run);
  if (kind >= 5 && kind < 8) motion_go_to(&law, &go_to);
  if (kind == 8) motion_stop(&law, 0);
  if (kind == 9) motion_stop(&law, SERVO_EMERGENCY_DPS2);
}

TEST(MotionLaw, KeepsLimitsAndAccelerationAtEveryStepWhateverIsCommanded) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 60; ++trial) {
    const int limit = std::uniform_int_distribution(100, 20000)(random);
    servo_configure servo = winch();
    servo.limit_acceleration_dps2 = static_cast<std::uint16_t>(limit);
    servo.angle_min_cdeg = -std::uniform_int_distribution(50, 100000)(random);
    servo.angle_max_cdeg = std::uniform_int_distribution(50, 100000)(random);
    motion law{};
    motion_start(&law, &servo, 0);
    for (int step = 0; step < 20'000; ++step) {
      if (random() % 300 == 0) command_at_random(law, random, limit);
      const std::int32_t before = law.rate;
      motion_step(&law);
      const int most = law.goal == MOTION_STOP || law.goal == MOTION_REST ? int{SERVO_EMERGENCY_DPS2} : limit;
      ASSERT_LE(std::abs(law.rate - before), most);
      ASSERT_GE(angle_udeg(law), servo.angle_min_cdeg * udeg_per_cdeg);
      ASSERT_LE(angle_udeg(law), servo.angle_max_cdeg * udeg_per_cdeg);
      ASSERT_LE(std::abs(law.rate), 300000);
    }
  }
}

TEST(MotionLaw, ARunKeepsToItsOwnAccelerationAtATurn) {
  servo_configure servo = winch();
  servo.angle_min_cdeg = -9000;
  servo.angle_max_cdeg = 9000;
  motion law{};
  motion_start(&law, &servo, 0);
  const servo_run run{1, SERVO_RUN_TURN_BACK, 20000, 3000, 20000};
  motion_run(&law, &run);
  for (int step = 0; step < 20'000; ++step) {
    const std::int32_t before = law.rate;
    motion_step(&law);
    ASSERT_LE(std::abs(law.rate - before), 3000);
  }
  EXPECT_EQ(law.goal, MOTION_REST);
}

TEST(MotionLaw, ThePulseIsTheAngleToHalfATickInEveryConfiguration) {
  std::mt19937 random(7);
  const auto between = [&](int low, int high) { return std::uniform_int_distribution(low, high)(random); };
  for (int trial = 0; trial < 20'000; ++trial) {
    servo_configure servo = winch();
    servo.pulse_min_us = static_cast<std::uint16_t>(between(500, 2499));
    servo.pulse_max_us = static_cast<std::uint16_t>(between(servo.pulse_min_us + 1, 2500));
    servo.span = static_cast<std::uint32_t>(between(2, trial % 2 == 0 ? 1000000 : 30000));
    const int half = static_cast<int>(servo.span / 2);
    motion law{};
    motion_start(&law, &servo, trial % 10 == 0 ? half : between(-half, half));
    if (law.angle_cdeg < half) law.angle_udeg = static_cast<std::uint16_t>(between(0, 9999));
    const double middle_us = (servo.pulse_min_us + servo.pulse_max_us) / 2.0;
    const double exact_us = middle_us + static_cast<double>(angle_udeg(law)) / udeg_per_cdeg / servo.span *
                                            (servo.pulse_max_us - servo.pulse_min_us);
    ASSERT_NEAR(pulse_ticks(&servo, &law), exact_us * SERVO_TICKS_PER_US, 0.5 + 1e-5) << servo.span;
  }
}

TEST(MotionLaw, SlowSpeedsLoseNothingToRounding) {
  motion law{};
  const servo_configure servo = winch();
  motion_start(&law, &servo, 0);
  const servo_run run{1, 0, 7, 20000, 60000};
  motion_run(&law, &run);
  for (int step = 0; step < 60'000; ++step) motion_step(&law);
  EXPECT_NEAR(static_cast<double>(angle_udeg(law)), 70.0 * 60'000, 70.0 * 2);
}

TEST(MotionLaw, GoToArrivesExactlyAndDoesNotOvershootFromRest) {
  std::mt19937 random(3);
  const servo_configure servo = winch();
  motion law{};
  motion_start(&law, &servo, 0);
  for (int trial = 0; trial < 100; ++trial) {
    const servo_go_to go_to{std::uniform_int_distribution(-100000, 100000)(random), 30000,
                            static_cast<std::uint16_t>(std::uniform_int_distribution(500, 20000)(random))};
    const bool up = go_to.angle_cdeg > law.angle_cdeg;
    motion_go_to(&law, &go_to);
    for (int step = 0; step < 12'000 && law.goal != MOTION_REST; ++step) {
      motion_step(&law);
      ASSERT_TRUE(up ? law.rate >= 0 : law.rate <= 0);
    }
    ASSERT_EQ(angle_udeg(law), go_to.angle_cdeg * udeg_per_cdeg);
  }
}

}  // namespace
}  // namespace thermorig::firmware_test
