// SPDX-License-Identifier: MIT
#include <cmath>
#include <numbers>

#include "bench.h"

namespace thermorig::firmware_test {
namespace {

class ServoSafety : public FirmwareTest {
 protected:
  void start_run(std::int32_t rate_cdps, const servo_configure& servo = winch()) {
    bench().open(servo);
    bench().command(SERVO_RUN, payload_of(servo_run{1, SERVO_RUN_TURN_BACK, rate_cdps, 5000, 20000}));
    bench().run_refreshed(600'000);
    ASSERT_EQ(bench().now().motion, SERVO_MOTION_STEADY);
  }
  void expect_stopped(servo_fault fault) {
    bench().run_for(60'000);
    EXPECT_EQ(bench().now().rate_cdps, 0);
    EXPECT_EQ(bench().now().motion, SERVO_MOTION_HOLDING);
    EXPECT_EQ(bench().now().fault, fault);
    EXPECT_EQ(count(bench(), SERVO_EVENT_FAULT, fault), 1);
    EXPECT_EQ(count(bench(), SERVO_EVENT_LEG_END, 1), 1);
  }
};

/// The last instant at which a shaft that follows the pulses as an 8 Hz second-order loop (damping 0.7) turns
/// faster than 1 deg/s. A pulse takes hold when it ends.
double last_motion_us(const std::vector<simulation::PulseEdge>& pulses, const servo_configure& servo,
                      double until_us) {
  constexpr double step_s = 1e-4, omega = 2.0 * std::numbers::pi * 8.0;
  const double deg_per_us = servo.span / 100.0 / (servo.pulse_max_us - servo.pulse_min_us);
  const bool continuous = servo.kind == SERVO_KIND_CONTINUOUS;
  double value = pulses.front().width_us * deg_per_us, slope = 0.0, last_us = 0.0;
  const double neutral = (servo.pulse_min_us + servo.pulse_max_us) / 2.0 * deg_per_us;
  double target = value;
  std::size_t next = 0;
  for (double time_us = 0.0; time_us < until_us; time_us += step_s * 1e6) {
    while (next < pulses.size() &&
           static_cast<double>(pulses[next].rise_us) + pulses[next].width_us <= time_us)
      target = pulses[next++].width_us * deg_per_us;
    slope += step_s * (omega * omega * (target - value) - 2.0 * 0.7 * omega * slope);
    value += step_s * slope;
    if (std::abs(continuous ? value - neutral : slope) >= 1.0) last_us = time_us;
  }
  return last_us;
}

TEST_P(ServoSafety, TheShaftIsAtRestWithin300MillisecondsOfTheLastByte) {
  const int phase_step_us = is_avr() ? 5'300 : 1'100;
  for (const std::int32_t rate_cdps : {2000, 10000, -20000, 30000}) {
    for (int phase_us = 0; phase_us < 20'000; phase_us += phase_step_us) {
      restart();
      start_run(rate_cdps);
      bench().run_for(phase_us);
      bench().send(frame(SERVO_REFRESH, 0, {}));
      const auto last_byte_us = static_cast<double>(bench().now_us());
      bench().run_for(600'000);
      const double last_us = last_motion_us(bench().pulses(), winch(), last_byte_us + 600'000);
      EXPECT_GT(last_us, last_byte_us + 100'000);  // it did run on until the watchdog tripped
      EXPECT_LT(last_us, last_byte_us + 300'000) << rate_cdps << " cdeg/s, phase " << phase_us << " us";
      EXPECT_EQ(bench().now().fault, SERVO_FAULT_WATCHDOG);
    }
  }
}

TEST_P(ServoSafety, AContinuousServoIsAtRestWithin300MillisecondsAsWell) {
  for (int phase_us = 0; phase_us < 20'000; phase_us += 3'300) {
    restart();
    start_run(20000, continuous());
    bench().run_for(phase_us);
    bench().send(frame(SERVO_REFRESH, 0, {}));
    const auto last_byte_us = static_cast<double>(bench().now_us());
    bench().run_for(600'000);
    EXPECT_LT(last_motion_us(bench().pulses(), continuous(), last_byte_us + 600'000), last_byte_us + 300'000);
  }
}

TEST_P(ServoSafety, TheWatchdogTripsOnlyAfter120Milliseconds) {
  start_run(20000);
  bench().run_for(75'000);
  bench().send(frame(SERVO_REFRESH, 0, {}));
  bench().run_for(115'000);
  EXPECT_EQ(bench().now().fault, SERVO_FAULT_NONE);
  EXPECT_EQ(bench().now().rate_cdps, 20000);
  bench().run_for(20'000);
  expect_stopped(SERVO_FAULT_WATCHDOG);
}

TEST_P(ServoSafety, NoiseDoesNotFeedTheWatchdog) {
  start_run(20000);
  for (int i = 0; i < 20; ++i) {
    bench().send({0x00, 0x55, 0xAA});
    bench().run_for(10'000);
  }
  expect_stopped(SERVO_FAULT_WATCHDOG);
}

TEST_P(ServoSafety, AServoAtRestNeedsNoRefresh) {
  bench().open(winch());
  bench().run_for(1'000'000);
  EXPECT_EQ(bench().now().fault, SERVO_FAULT_NONE);
  EXPECT_EQ(bench().now().motion, SERVO_MOTION_HOLDING);
}

TEST_P(ServoSafety, StopsAtARawStopByteWithTheEmergencyDeceleration) {
  start_run(20000);
  const std::int32_t before_cdeg = bench().now().angle_cdeg;
  bench().send({SERVO_LINK_STOP});
  expect_stopped(SERVO_FAULT_STOP_BYTE);
  // 10 ms of age of the telemetry, a tick, and v^2 / 2a = 1 degree.
  EXPECT_LT(bench().now().angle_cdeg - before_cdeg, 20000 * 0.04 + 100);
}

TEST_P(ServoSafety, StopsAtAStopByteInsideAFrame) {
  start_run(-20000);
  Bytes run = frame(SERVO_RUN, bench().next_sequence, payload_of(servo_run{2, 0, 10000, 5000, 100}));
  run.insert(run.begin() + 6, SERVO_LINK_STOP);
  bench().send(run);
  expect_stopped(SERVO_FAULT_STOP_BYTE);
}

TEST_P(ServoSafety, StopsAtAStopByteBehindAnEscape) {
  start_run(20000);
  bench().send({SERVO_LINK_FLAG, SERVO_HALT, SERVO_LINK_ESCAPE, SERVO_LINK_STOP});
  expect_stopped(SERVO_FAULT_STOP_BYTE);
}

TEST_P(ServoSafety, LatchesAStopByteInEveryStateUntilItIsArmed) {
  bench().send({SERVO_LINK_STOP});
  bench().run_for(20'000);
  EXPECT_EQ(bench().now().fault, SERVO_FAULT_STOP_BYTE);
  bench().open(winch());
  bench().run_for(20'000);
  EXPECT_EQ(bench().now().fault, SERVO_FAULT_NONE);
  bench().send({SERVO_LINK_STOP});
  bench().run_for(20'000);
  EXPECT_EQ(bench().now().fault, SERVO_FAULT_STOP_BYTE);
}

TEST_P(ServoSafety, ThreeDamagedFramesInARowStopAMotion) {
  start_run(20000);
  Bytes damaged = frame(SERVO_HALT, 0, {});
  damaged[2] ^= 0x01;
  for (int i = 0; i < 2; ++i) bench().send(damaged);
  bench().send(frame(SERVO_REFRESH, 0, {}));
  for (int i = 0; i < 2; ++i) bench().send(damaged);
  bench().run_for(30'000);
  EXPECT_EQ(bench().now().fault, SERVO_FAULT_NONE);
  bench().send(damaged);
  expect_stopped(SERVO_FAULT_BAD_FRAMES);
}

TEST_P(ServoSafety, AFaultRefusesMotionUntilItIsArmedAgain) {
  start_run(20000);
  bench().send({SERVO_LINK_STOP});
  bench().run_for(100'000);
  const auto stopped = bench().now();
  EXPECT_EQ(reason(bench().command(SERVO_RUN, payload_of(servo_run{1, 0, 1000, 1000, 100}))),
            SERVO_REASON_FAULT);
  EXPECT_EQ(reason(bench().command(SERVO_GO_TO, payload_of(servo_go_to{0, 1000, 1000}))), SERVO_REASON_FAULT);
  EXPECT_EQ(bench().command(SERVO_ARM, payload_of(servo_arm{-5000})).type, SERVO_ACK);
  bench().run_for(60'000);
  EXPECT_EQ(bench().now().fault, SERVO_FAULT_NONE);
  EXPECT_EQ(bench().now().angle_cdeg, stopped.angle_cdeg);  // still armed: it holds where it is
  EXPECT_EQ(bench().command(SERVO_RUN, payload_of(servo_run{1, 0, 1000, 1000, 100})).type, SERVO_ACK);
}

TEST_P(ServoSafety, DisarmDuringAMotionStopsFirst) {
  start_run(20000);
  EXPECT_EQ(bench().command(SERVO_DISARM).type, SERVO_ACK);
  bench().run_for(200'000);
  EXPECT_EQ(bench().now().motion, SERVO_MOTION_DISARMED);
  EXPECT_EQ(bench().now().rate_cdps, 0);
  EXPECT_EQ(bench().now().pulse_ticks, 0);
}

TEST_P(ServoSafety, ANewHelloBringsAMotionToRest) {
  start_run(20000);
  bench().hello();
  bench().run_refreshed(300'000);
  EXPECT_EQ(bench().now().motion, SERVO_MOTION_HOLDING);
  EXPECT_EQ(bench().now().rate_cdps, 0);
}

INSTANTIATE_TEST_SUITE_P(Both, ServoSafety, testing::Values(Form::host_build, Form::avr_image),
                         [](const auto& form) {
                           return form.param == Form::host_build ? "HostBuild" : "AvrImage";
                         });

}  // namespace
}  // namespace thermorig::firmware_test
