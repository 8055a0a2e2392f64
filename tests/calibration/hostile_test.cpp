// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "calibrated_rig.h"
#include "thermorig/core/error.h"
#include "thermorig/rig/calibration/calibration.h"

namespace thermorig::calibration {
namespace {

/// Each calibration gives a finite result or an Error, whatever it is fed.
void try_all(const session::Session& session) {
  const auto attempt = [](auto measure) {
    try {
      measure();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::finished_lossy);
    }
  };
  attempt([&] { EXPECT_TRUE(std::isfinite(measure_bias(session).bias_dps.value)); });
  attempt([&] { EXPECT_TRUE(std::isfinite(measure_latency(session).camera_latency_s.value)); });
  attempt([&] { EXPECT_TRUE(std::isfinite(measure_scale(session).gyro_scale.value)); });
  attempt([&] { EXPECT_TRUE(std::isfinite(measure_scale_by_marks(session, 360.0).gyro_scale.value)); });
  attempt([&] { EXPECT_TRUE(std::isfinite(measure_lens(session).pitch_scale.value)); });
  attempt([&] { EXPECT_NE(measure_orientation(session).gyro_sign, 0); });
}

session::Session moving_session() {
  const auto config = rig_with(1);
  return record(config, plan_for(rig::CalibrationKind::orientation, config)).session;
}

TEST(HostileSessions, WithTwoMessagesOfEachDeviceAreRefused) {
  session::Session session = moving_session();
  session.frames.resize(2);
  session.gyro.resize(2);
  session.servo.resize(2);
  try_all(session);
}

TEST(HostileSessions, WithNumbersThatAreNoneAreEndured) {
  session::Session session = moving_session();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 0; i < session.gyro.size(); i += 3) {
    session.gyro[i].rate_dps = nan;
    session.gyro[i].reading.rate_dps = {nan, std::numeric_limits<float>::infinity(), 1e30F};
  }
  for (std::size_t i = 0; i < session.frames.size(); i += 5) session.frames[i].frame.temp_c.fill(nan);
  try_all(session);
}

TEST(HostileSessions, WithOneDeviceAloneAreRefused) {
  const session::Session whole = moving_session();
  session::Session frames, gyro, servo;
  frames.frames = whole.frames;
  gyro.gyro = whole.gyro;
  servo.servo = whole.servo;
  for (const session::Session& session : {frames, gyro, servo}) try_all(session);
}

TEST(HostileSessions, WhoseTimesAreAllTheSameAreEndured) {
  session::Session session = moving_session();
  for (TimedGyro& sample : session.gyro) sample.stamp.time = session.gyro.front().stamp.time;
  for (TimedServo& message : session.servo) message.stamp.time = session.gyro.front().stamp.time;
  try_all(session);
}

TEST(HostileSessions, WhoseLastMessageCameAgesLaterAreEndured) {
  session::Session session = moving_session();
  session.servo.back().stamp.time += from_s(9e9);
  session.gyro.back().stamp.time += from_s(9e9);
  try_all(session);
}

/// At rest but for three short moves of the servo; nobody turned the rig.
session::Session short_rests() {
  session::Session session;
  for (int i = 0; i < 2000; ++i) {
    TimedServo message;
    message.stamp.time = HostTime(from_s(0.01 * i));
    message.state.motion = i % 400 < 350 ? ServoMotion::holding : ServoMotion::steady;
    message.state.rate_dps = i % 400 < 350 ? 0.0 : 50.0;
    session.servo.push_back(message);
    for (const int half : {0, 1}) {
      TimedGyro sample;
      sample.stamp.time = HostTime(from_s(0.01 * i + 0.005 * half));
      sample.rate_dps = static_cast<float>(message.state.rate_dps) + (half == 0 ? 0.02F : -0.02F);
      session.gyro.push_back(sample);
    }
  }
  return session;
}

TEST(HostileSessions, InWhichNobodyTurnedTheRigSaySo) {
  try {
    measure_scale_by_marks(short_rests(), 360.0);
    FAIL() << "a scale without a turn";
  } catch (const Error& error) {
    EXPECT_EQ(error.what_happened(), "the rig was not turned");
  }
}

}  // namespace
}  // namespace thermorig::calibration
