// SPDX-License-Identifier: MIT
#include <cmath>
#include <random>

#include "bench.h"

namespace thermorig::firmware_test {
namespace {

class ServoMotion : public FirmwareTest {
 protected:
  /// By how many ticks a pulse's width may be off as it is seen: simavr shows an edge at the end of the
  /// instruction in hand, up to 3 cycles late.
  double unseen_ticks() const { return is_avr() ? 3.0 : 0.0; }
  void run(const servo_run& asked) {
    ASSERT_EQ(bench().command(SERVO_RUN, payload_of(asked)).type, SERVO_ACK);
  }
  void go_to(const servo_go_to& asked) {
    ASSERT_EQ(bench().command(SERVO_GO_TO, payload_of(asked)).type, SERVO_ACK);
  }
  /// Every change of speed in the telemetry is one that `acceleration_dps2` allows.
  void expect_acceleration_within(double acceleration_dps2) {
    const auto& telemetry = bench().telemetry();
    for (std::size_t i = 1; i < telemetry.size(); ++i)
      ASSERT_LE(std::abs(telemetry[i].rate_cdps - telemetry[i - 1].rate_cdps), acceleration_dps2 + 1.0);
  }
};

double pulse_angle_cdeg(const simulation::PulseEdge& pulse, const servo_configure& servo) {
  const double middle_us = (servo.pulse_min_us + servo.pulse_max_us) / 2.0;
  return (pulse.width_us - middle_us) * servo.span / (servo.pulse_max_us - servo.pulse_min_us);
}

TEST_P(ServoMotion, GivesNoPulseBeforeItIsArmed) {
  bench().hello();
  bench().command(SERVO_CONFIGURE, payload_of(winch()));
  bench().run_for(200'000);
  EXPECT_TRUE(bench().pulses().empty());
  for (const auto& telemetry : bench().telemetry()) EXPECT_EQ(telemetry.pulse_ticks, 0);
}

TEST_P(ServoMotion, ArmsAtTheAngleGivenAndStopsPulsingWhenDisarmed) {
  bench().open(winch(), 54000);
  bench().run_for(200'000);
  ASSERT_GE(bench().pulses().size(), 8U);
  for (const auto& pulse : bench().pulses()) EXPECT_DOUBLE_EQ(pulse.width_us, 2000.0);
  EXPECT_EQ(bench().command(SERVO_DISARM).type, SERVO_ACK);
  bench().run_for(40'000);
  const std::size_t pulses = bench().pulses().size();
  bench().run_for(200'000);
  EXPECT_EQ(bench().pulses().size(), pulses);
  EXPECT_EQ(bench().now().motion, SERVO_MOTION_DISARMED);
  EXPECT_EQ(bench().now().pulse_ticks, 0);
}

TEST_P(ServoMotion, PulsesAreTwentyMillisecondsApart) {
  bench().open(winch());
  run({1, 0, 20000, 2000, 1000});
  bench().run_refreshed(1'200'000);
  const auto& pulses = bench().pulses();
  ASSERT_GT(pulses.size(), 50U);
  for (std::size_t i = 1; i < pulses.size(); ++i)
    EXPECT_NEAR(static_cast<double>(pulses[i].rise_us - pulses[i - 1].rise_us), 20'000.0, 1.0);
}

TEST_P(ServoMotion, WidensThePulsesEvenlyAtASlowSpeed) {
  bench().open(winch());
  run({1, 0, 2000, 20000, 3000});
  bench().run_refreshed(2'500'000);
  const auto& pulses = bench().pulses();
  ASSERT_GT(pulses.size(), 110U);
  for (std::size_t i = 20; i < pulses.size(); ++i) {
    const double ticks = (pulses[i].width_us - pulses[i - 1].width_us) * SERVO_TICKS_PER_US;
    const double even = 0.4 / 2160.0 * 2000.0 * SERVO_TICKS_PER_US;  // 0.4 degrees a pulse: 5.9 ticks
    EXPECT_NEAR(ticks, even, 1.0 + 2.0 * unseen_ticks());
    EXPECT_EQ(ticks, std::round(ticks));
  }
}

TEST_P(ServoMotion, ArmingAndDisarmingAtAnyInstantCutsNoPulseAndDoublesNone) {
  std::mt19937 random(5);
  bench().open(winch(), 107800);
  for (int i = 0; i < (is_avr() ? 30 : 200); ++i) {
    bench().run_for(std::uniform_int_distribution(100, 45'000)(random));
    ASSERT_EQ(bench().command(SERVO_DISARM).type, SERVO_ACK);
    bench().run_for(std::uniform_int_distribution(100, 45'000)(random));
    ASSERT_EQ(bench().command(SERVO_ARM, payload_of(servo_arm{107800})).type, SERVO_ACK);
  }
  const auto& pulses = bench().pulses();
  ASSERT_GT(pulses.size(), 30U);
  for (const auto& pulse : pulses) {
    EXPECT_NEAR(pulse.width_us * SERVO_TICKS_PER_US, 39970.0, unseen_ticks());
    EXPECT_LE((pulse.rise_us - pulses.front().rise_us + 1) % 20'000, 2) << pulse.rise_us;
  }
}

TEST_P(ServoMotion, RunsAtConstantSpeedAndEndsInTime) {
  for (const std::int32_t rate_cdps : {2000, 20000, -20000, -750}) {
    restart();
    bench().open(winch());
    const auto answer = bench().command(SERVO_RUN, payload_of(servo_run{9, 0, rate_cdps, 2000, 3000}));
    const std::uint32_t started_us = servo_get_u32(&answer.payload[1]);
    bench().run_refreshed(3'200'000);
    int steady = 0;
    for (const auto& telemetry : bench().telemetry()) {
      if (telemetry.motion != SERVO_MOTION_STEADY) continue;
      EXPECT_EQ(telemetry.rate_cdps, rate_cdps);
      EXPECT_EQ(telemetry.leg, 9);
      ++steady;
    }
    EXPECT_NEAR(steady, 300 - 2 * std::abs(rate_cdps) / 2000, 3);
    // A trapezium: the speed times the duration without one ramp.
    EXPECT_NEAR(bench().now().angle_cdeg, rate_cdps * (3.0 - std::abs(rate_cdps) / 200000.0),
                std::abs(rate_cdps) * 0.002 + 1);
    EXPECT_EQ(bench().now().motion, SERVO_MOTION_HOLDING);
    ASSERT_EQ(bench().events().back().kind, SERVO_EVENT_LEG_END);
    EXPECT_NEAR(bench().events().back().mcu_us - started_us, 3'000'000, 2'000);
    EXPECT_EQ(count(bench(), SERVO_EVENT_LEG_START, 9), 1);
  }
}

TEST_P(ServoMotion, AngleOfThePulsesAgreesWithTelemetry) {
  bench().open(winch());
  run({1, SERVO_RUN_TURN_BACK, 20000, 2000, 8000});
  bench().run_refreshed(8'200'000);
  std::size_t next = 0;
  int compared = 0;
  const auto& telemetry = bench().telemetry();
  for (const auto& pulse : bench().pulses()) {
    while (next < telemetry.size() && telemetry[next].mcu_us + 5'000 < pulse.rise_us) ++next;
    if (next >= telemetry.size() || telemetry[next].mcu_us > pulse.rise_us + 1'000) continue;
    const auto& state = telemetry[next];
    EXPECT_NEAR(state.pulse_ticks, pulse.width_us * SERVO_TICKS_PER_US, unseen_ticks())
        << "at " << pulse.rise_us;
    // The pulse was set a millisecond before it rose; half a tick is 3.4 centidegrees of this winch.
    EXPECT_NEAR(pulse_angle_cdeg(pulse, winch()), state.angle_cdeg - state.rate_cdps * 0.001, 24.0);
    ++compared;
  }
  EXPECT_GT(compared, 300);
}

TEST_P(ServoMotion, KeepsToTheAccelerationOfTheCommand) {
  bench().open(winch());
  run({1, 0, 20000, 500, 2000});
  bench().run_refreshed(2'100'000);
  go_to({0, 20000, 700});
  bench().run_refreshed(2'500'000);
  expect_acceleration_within(700);
  EXPECT_EQ(bench().now().angle_cdeg, 0);
}

TEST_P(ServoMotion, TurnsBackAtTheLimitsAtTheSameSpeed) {
  servo_configure servo = winch();
  servo.angle_min_cdeg = -9000;
  servo.angle_max_cdeg = 9000;
  bench().open(servo);
  run({5, SERVO_RUN_TURN_BACK, 20000, 4000, 10000});
  bench().run_refreshed(10'200'000);
  int lowest = 0, highest = 0, backwards = 0;
  for (const auto& telemetry : bench().telemetry()) {
    lowest = std::min(lowest, telemetry.angle_cdeg);
    highest = std::max(highest, telemetry.angle_cdeg);
    backwards += telemetry.rate_cdps == -20000 && telemetry.motion == SERVO_MOTION_STEADY;
  }
  EXPECT_GE(lowest, -9000);
  EXPECT_LE(highest, 9000);
  EXPECT_LT(lowest, -8800);
  EXPECT_GT(highest, 8800);
  EXPECT_GT(backwards, 300);
  EXPECT_NEAR(count(bench(), SERVO_EVENT_REVERSAL, 5), 10, 1);
  EXPECT_EQ(count(bench(), SERVO_EVENT_LEG_START, 5), 1);
  EXPECT_EQ(count(bench(), SERVO_EVENT_LEG_END, 5), 1);
  EXPECT_EQ(bench().now().fault, SERVO_FAULT_NONE);
}

TEST_P(ServoMotion, ARunThatMayNotTurnBackStopsExactlyAtTheLimitWithAFault) {
  servo_configure servo = winch();
  servo.angle_max_cdeg = 9000;
  bench().open(servo);
  run({5, 0, 20000, 4000, 10000});
  bench().run_refreshed(2'000'000);
  EXPECT_EQ(bench().now().angle_cdeg, 9000);
  EXPECT_EQ(bench().now().fault, SERVO_FAULT_LIMIT);
  EXPECT_EQ(count(bench(), SERVO_EVENT_FAULT, SERVO_FAULT_LIMIT), 1);
  EXPECT_EQ(count(bench(), SERVO_EVENT_LEG_END, 5), 1);
  EXPECT_EQ(reason(bench().command(SERVO_RUN, payload_of(servo_run{5, 0, -20000, 4000, 100}))),
            SERVO_REASON_FAULT);
}

TEST_P(ServoMotion, GoesToAnAngleExactly) {
  bench().open(winch());
  for (const std::int32_t angle_cdeg : {1, 4500, -30000, -29999, 107800}) {
    go_to({angle_cdeg, 30000, 5000});
    do bench().run_refreshed(100'000);
    while (bench().now().motion != SERVO_MOTION_HOLDING && bench().now_us() < 60'000'000);
    EXPECT_EQ(bench().now().angle_cdeg, angle_cdeg);
    EXPECT_EQ(bench().now().motion, SERVO_MOTION_HOLDING);
  }
}

TEST_P(ServoMotion, ARunTakesOverWithoutStopping) {
  bench().open(winch());
  run({1, 0, 10000, 2000, 5000});
  bench().run_refreshed(1'000'000);
  run({2, 0, 20000, 2000, 2000});
  const std::size_t before = bench().telemetry().size();
  bench().run_refreshed(1'500'000);
  for (std::size_t i = before; i < bench().telemetry().size(); ++i)
    EXPECT_GE(bench().telemetry()[i].rate_cdps, 10000);
  EXPECT_EQ(count(bench(), SERVO_EVENT_LEG_END, 1), 1);
  EXPECT_EQ(count(bench(), SERVO_EVENT_LEG_START, 2), 1);
}

TEST_P(ServoMotion, HaltComesToRestAndStaysArmed) {
  bench().open(winch());
  run({1, 0, 20000, 2000, 5000});
  bench().run_refreshed(500'000);
  EXPECT_EQ(bench().command(SERVO_HALT).type, SERVO_ACK);
  bench().run_refreshed(200'000);
  EXPECT_EQ(bench().now().motion, SERVO_MOTION_HOLDING);
  EXPECT_EQ(bench().now().fault, SERVO_FAULT_NONE);
  EXPECT_NE(bench().now().pulse_ticks, 0);
  EXPECT_EQ(count(bench(), SERVO_EVENT_LEG_END, 1), 1);
}

TEST_P(ServoMotion, ARestIsALegAsWell) {
  bench().open(winch());
  run({4, 0, 0, 2000, 500});
  bench().run_refreshed(600'000);
  EXPECT_EQ(bench().now().angle_cdeg, 0);
  EXPECT_EQ(count(bench(), SERVO_EVENT_LEG_START, 4), 1);
  EXPECT_EQ(count(bench(), SERVO_EVENT_LEG_END, 4), 1);
}

TEST_P(ServoMotion, AContinuousServoTurnsItsRateIntoAPulse) {
  bench().open(continuous());
  run({1, 0, 15000, 5000, 2000});
  bench().run_refreshed(1'000'000);
  EXPECT_EQ(bench().now().rate_cdps, 15000);
  EXPECT_EQ(bench().now().pulse_ticks, 1750 * SERVO_TICKS_PER_US);
  EXPECT_DOUBLE_EQ(bench().pulses().back().width_us, 1750.0);
  bench().run_refreshed(1'200'000);
  EXPECT_EQ(bench().now().pulse_ticks, 1500 * SERVO_TICKS_PER_US);
  EXPECT_NEAR(bench().now().angle_cdeg, 15000 * (2.0 - 0.03), 50);
  EXPECT_EQ(reason(bench().command(SERVO_GO_TO, payload_of(servo_go_to{0, 2000, 2000}))),
            SERVO_REASON_BAD_VALUE);
}

TEST_P(ServoMotion, RandomCommandsNeverLeaveTheTravelLimits) {
  servo_configure servo = winch();
  servo.angle_min_cdeg = -3000;
  servo.angle_max_cdeg = 5000;
  std::mt19937 random(11);
  const auto between = [&](int low, int high) { return std::uniform_int_distribution(low, high)(random); };
  bench().open(servo);
  for (int i = 0; i < (is_avr() ? 50 : 300); ++i) {
    const auto acceleration = static_cast<std::uint16_t>(between(100, 20000));
    const auto turn = static_cast<std::uint8_t>(between(0, 9) > 0);
    const auto duration = static_cast<std::uint32_t>(between(1, 1500));
    if (between(0, 3) > 0)
      bench().command(SERVO_RUN,
                      payload_of(servo_run{1, turn, between(-30000, 30000), acceleration, duration}));
    else
      bench().command(SERVO_GO_TO, payload_of(servo_go_to{between(-3000, 5000), 30000, acceleration}));
    if (between(0, 5) == 0) bench().command(SERVO_HALT);
    if (between(0, 9) == 0) bench().send({SERVO_LINK_STOP});
    bench().run_refreshed(between(10, 400) * 1000);
    if (bench().now().fault != SERVO_FAULT_NONE) bench().command(SERVO_ARM, payload_of(servo_arm{0}));
  }
  for (const auto& telemetry : bench().telemetry()) {
    ASSERT_GE(telemetry.angle_cdeg, -3000);
    ASSERT_LE(telemetry.angle_cdeg, 5000);
    ASSERT_LE(std::abs(telemetry.rate_cdps), 30000);
  }
  // A tick of the pulse is 27 centidegrees of this winch, and simavr's edges lie within a cycle or two.
  for (const auto& pulse : bench().pulses()) {
    ASSERT_GE(pulse_angle_cdeg(pulse, servo), -3000 - 40);
    ASSERT_LE(pulse_angle_cdeg(pulse, servo), 5000 + 40);
  }
}

INSTANTIATE_TEST_SUITE_P(Both, ServoMotion, testing::Values(Form::host_build, Form::avr_image),
                         [](const auto& form) {
                           return form.param == Form::host_build ? "HostBuild" : "AvrImage";
                         });

}  // namespace
}  // namespace thermorig::firmware_test
