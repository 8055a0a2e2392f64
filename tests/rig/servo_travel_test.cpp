// SPDX-License-Identifier: MIT
#include "rig/sweep/servo_travel.h"

#include <gtest/gtest.h>

#include "test_servos.h"

namespace thermorig::rig::test {
namespace {

/// A travel of 200 degrees to either side of the middle.
ServoProfile servo_of_400() {
  ServoProfile servo = servo_of(400.0);
  servo.stop_margin_deg = 0.0;
  servo.acceleration_dps2 = 1000.0;
  return servo;
}

TEST(ServoTravel, ALegCoversAtMostTheWayFromEndToEnd) {
  const ServoTravel travel(servo_of_400());
  EXPECT_LT(travel.way_deg(100.0, 12, 8.0), 400.0);
  EXPECT_EQ(travel.way_deg(100.0, 57, 8.0), 400.0);
  EXPECT_FALSE(travel.is_too_short_for(100.0, 12, 8.0));
  EXPECT_TRUE(travel.is_too_short_for(100.0, 57, 8.0));
}

TEST(ServoTravel, AContinuousServoHasNoEnd) {
  const ServoTravel travel(continuous_servo());
  EXPECT_FALSE(travel.is_too_short_for(100.0, 5000, 8.0));
  EXPECT_EQ(travel.frames_left(100.0, 1e6, 8.0, 57), 57);
}

TEST(ServoTravel, ALegLiesEvenAboutTheMiddleInItsDirection) {
  EXPECT_EQ(ServoTravel::start_deg(30.0, 100.0), -50.0);
  EXPECT_EQ(ServoTravel::start_deg(-30.0, 100.0), 50.0);
}

TEST(ServoTravel, HasRoomForALegThatEndsBeforeItsEnd) {
  const ServoTravel travel(servo_of_400());
  EXPECT_TRUE(travel.has_room(30.0, 300.0, -100.0));
  EXPECT_FALSE(travel.has_room(-30.0, 300.0, -100.0));
  EXPECT_FALSE(travel.has_room(30.0, 300.03, -100.0));
  EXPECT_TRUE(travel.has_room(30.0, 300.03, -100.0, 0.05));
}

TEST(ServoTravel, LeavesRoomForTheCommandAndTheBraking) {
  const ServoTravel travel(servo_of_400());
  // 200 - 100 deg ahead, 5 of them to brake: 0.95 s at 100 deg/s, a quarter second of it until the command.
  EXPECT_EQ(travel.frames_left(100.0, 100.0, 10.0, 57), 6);
  EXPECT_EQ(travel.frames_left(-100.0, -100.0, 10.0, 57), 6);
  EXPECT_EQ(travel.frames_left(100.0, 190.0, 10.0, 57), 0);
  EXPECT_EQ(travel.frames_left(100.0, -200.0, 10.0, 4), 4);
}

}  // namespace
}  // namespace thermorig::rig::test
