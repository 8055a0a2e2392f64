// SPDX-License-Identifier: MIT
// A continuous servo with angle limits: its cable is never wound up further, and its turns are counted from
// one arming to the next.
#include <cmath>

#include "bench.h"

extern "C" {
#include "servo.h"
}

namespace thermorig::firmware_test {
namespace {

constexpr std::int32_t guard_cdeg = 20'000;

servo_configure guarded() {
  servo_configure servo = continuous();
  servo.angle_min_cdeg = -guard_cdeg;
  servo.angle_max_cdeg = guard_cdeg;
  return servo;
}

class CableGuard : public FirmwareTest {
 protected:
  void turn(std::int32_t rate_cdps, std::uint8_t flags, std::int64_t for_us) {
    ASSERT_EQ(bench().command(SERVO_RUN, payload_of(servo_run{1, flags, rate_cdps, 2000, 60'000})).type,
              SERVO_ACK);
    bench().run_refreshed(for_us);
  }
  void expect_never_beyond() {
    for (const servo_telemetry& state : bench().telemetry()) {
      ASSERT_LE(std::abs(state.angle_cdeg), guard_cdeg);
      ASSERT_LE(std::abs(state.rate_cdps), 20'000);
    }
  }
  void rearm() {
    ASSERT_EQ(bench().command(SERVO_DISARM).type, SERVO_ACK);
    bench().run_for(500'000);
    ASSERT_EQ(bench().command(SERVO_ARM, payload_of(servo_arm{0})).type, SERVO_ACK);
  }
};

TEST_P(CableGuard, StopsATurnAtItsEndAndSaysSo) {
  bench().open(guarded());
  turn(10'000, 0, 4'000'000);
  EXPECT_EQ(bench().now().fault, SERVO_FAULT_LIMIT);
  EXPECT_EQ(bench().now().angle_cdeg, guard_cdeg);
  EXPECT_EQ(bench().now().rate_cdps, 0);
  expect_never_beyond();
}

TEST_P(CableGuard, TurnsBackWhereItIsAskedTo) {
  bench().open(guarded());
  turn(15'000, SERVO_RUN_TURN_BACK, 6'000'000);
  EXPECT_EQ(bench().now().fault, SERVO_FAULT_NONE);
  EXPECT_GE(count(bench(), SERVO_EVENT_REVERSAL, 1), 1);
  expect_never_beyond();
}

TEST_P(CableGuard, CountsOnFromOneArmingToTheNext) {
  bench().open(guarded());
  turn(10'000, 0, 500'000);
  const std::int32_t wound_cdeg = bench().now().angle_cdeg;
  ASSERT_GT(wound_cdeg, 3'000);
  bench().command(SERVO_HALT);
  bench().run_refreshed(200'000);
  rearm();
  bench().run_for(30'000);
  EXPECT_GE(bench().now().angle_cdeg, wound_cdeg);
  turn(10'000, 0, 4'000'000);
  expect_never_beyond();
}

TEST_P(CableGuard, UnwindsWithGoTo) {
  bench().open(guarded());
  turn(10'000, 0, 800'000);
  bench().command(SERVO_HALT);
  bench().run_refreshed(200'000);
  ASSERT_EQ(bench().command(SERVO_GO_TO, payload_of(servo_go_to{-5'000, 10'000, 2000})).type, SERVO_ACK);
  bench().run_refreshed(3'000'000);
  EXPECT_EQ(bench().now().angle_cdeg, -5'000);
  EXPECT_EQ(bench().now().motion, SERVO_MOTION_HOLDING);
  expect_never_beyond();
}

TEST_P(CableGuard, LetsACableThatIsWoundTooFarMoveOnlyBack) {
  bench().open(continuous());
  turn(20'000, 0, 3'000'000);  // unguarded: 600 degrees
  bench().command(SERVO_HALT);
  bench().run_refreshed(300'000);
  bench().command(SERVO_DISARM);
  bench().run_for(300'000);
  const std::int32_t wound_cdeg = bench().now().angle_cdeg;
  ASSERT_GT(wound_cdeg, 2 * guard_cdeg);
  bench().open(guarded());
  bench().run_for(30'000);
  EXPECT_EQ(bench().now().angle_cdeg, wound_cdeg);
  turn(10'000, 0, 200'000);
  EXPECT_EQ(bench().now().fault, SERVO_FAULT_LIMIT);
  EXPECT_EQ(bench().now().angle_cdeg, wound_cdeg);
  ASSERT_EQ(bench().command(SERVO_ARM, payload_of(servo_arm{0})).type, SERVO_ACK);
  ASSERT_EQ(bench().command(SERVO_GO_TO, payload_of(servo_go_to{5'000, 20'000, 2000})).type, SERVO_ACK);
  bench().run_refreshed(5'000'000);
  EXPECT_EQ(bench().now().angle_cdeg, 5'000);
  EXPECT_EQ(bench().now().fault, SERVO_FAULT_NONE);
  turn(10'000, 0, 4'000'000);
  EXPECT_EQ(bench().now().angle_cdeg, guard_cdeg);
}

TEST_P(CableGuard, CountsUnguardedTurnsOfEveryArming) {
  bench().open(continuous());
  turn(10'000, 0, 500'000);
  bench().command(SERVO_HALT);
  bench().run_refreshed(200'000);
  const std::int32_t first_cdeg = bench().now().angle_cdeg;
  rearm();
  bench().run_for(30'000);
  EXPECT_EQ(bench().now().angle_cdeg, 0);  // as a host expects that guards nothing
  bench().command(SERVO_DISARM);
  bench().open(guarded());
  bench().run_for(30'000);
  EXPECT_EQ(bench().now().angle_cdeg, first_cdeg);
}

TEST_P(CableGuard, IsNoneWithoutLimits) {
  bench().open(continuous());
  turn(20'000, 0, 3'000'000);
  EXPECT_GT(bench().now().angle_cdeg, guard_cdeg);
  EXPECT_EQ(reason(bench().command(SERVO_GO_TO, payload_of(servo_go_to{0, 1000, 1000}))),
            SERVO_REASON_BAD_VALUE);
}

TEST_P(CableGuard, RefusesLimitsThatMakeNoSense) {
  bench().hello();
  servo_configure servo = guarded();
  servo.angle_min_cdeg = guard_cdeg + 1;
  EXPECT_EQ(reason(bench().command(SERVO_CONFIGURE, payload_of(servo))), SERVO_REASON_BAD_VALUE);
  servo.angle_min_cdeg = guard_cdeg - 50;
  EXPECT_EQ(reason(bench().command(SERVO_CONFIGURE, payload_of(servo))), SERVO_REASON_BEYOND_LIMIT);
  servo.angle_min_cdeg = -2'000'000'000;
  EXPECT_EQ(reason(bench().command(SERVO_CONFIGURE, payload_of(servo))), SERVO_REASON_BEYOND_LIMIT);
}

INSTANTIATE_TEST_SUITE_P(Both, CableGuard, testing::Values(Form::host_build, Form::avr_image),
                         [](const auto& form) {
                           return form.param == Form::host_build ? "HostBuild" : "AvrImage";
                         });

// What a board does after a reset through which its memory lived on.
TEST(RememberedAngle, IsShownBeforeArmingSoThatTheFirstPulseMovesNothing) {
  servo servo{};
  servo_init(&servo, SERVO_BOARD_HOST, 2);
  servo_remember(&servo, -4'321, 65'432);
  EXPECT_EQ(servo.motion.angle_cdeg, -4'321);
  EXPECT_EQ(servo.motion.cable_cdeg, 65'432);
  EXPECT_TRUE(motion_is_at_rest(&servo.motion));
  EXPECT_EQ(servo_next_pulse(&servo), 0);
}

// No host need come to this: three weeks of unguarded turning.
TEST(WoundCable, IsUnwoundFromAnySum) {
  for (const std::int32_t cable_cdeg : {INT32_MAX, INT32_MIN}) {
    motion motion{};
    motion.cable_cdeg = cable_cdeg;
    const servo_configure limits = guarded();
    const servo_run outwards{1, 0, cable_cdeg > 0 ? 1'000 : -1'000, 2000, 60'000};
    motion_start(&motion, &limits, 0);
    motion_run(&motion, &outwards);
    EXPECT_TRUE((motion_step(&motion) & MOTION_AT_LIMIT) != 0);
    EXPECT_EQ(motion.angle_cdeg, cable_cdeg);
    const servo_go_to back{0, 20'000, 2000};
    motion_go_to(&motion, &back);
    for (int i = 0; i < 100; ++i) motion_step(&motion);
    EXPECT_LT(std::abs(static_cast<std::int64_t>(motion.angle_cdeg)),
              std::abs(static_cast<std::int64_t>(cable_cdeg)) - 100);
  }
}

}  // namespace
}  // namespace thermorig::firmware_test
