// SPDX-License-Identifier: MIT
#include "thermorig/storage/session/servo_rests.h"

#include <gtest/gtest.h>

namespace thermorig::session {
namespace {

/// Ten messages a second, one for each letter: h holding, d disarmed, m moving, c holding at a crawl.
std::vector<TimedServo> servo_of(const std::string& motions) {
  std::vector<TimedServo> servo(motions.size());
  for (std::size_t i = 0; i < motions.size(); ++i) {
    servo[i].stamp.time = host_time_ns(100'000'000 * static_cast<std::int64_t>(i));
    servo[i].state.motion = motions[i] == 'm'   ? ServoMotion::steady
                            : motions[i] == 'd' ? ServoMotion::disarmed
                                                : ServoMotion::holding;
    servo[i].state.rate_dps = motions[i] == 'm' || motions[i] == 'c' ? 0.5 : 0.0;
  }
  return servo;
}

using Rests = std::vector<std::pair<std::int64_t, std::int64_t>>;

/// In milliseconds.
Rests rests_of(const std::string& motions) {
  Rests rests;
  for (const Rest& rest : servo_rests(servo_of(motions)))
    rests.emplace_back(to_ns(rest.begin) / 1'000'000, to_ns(rest.end) / 1'000'000);
  return rests;
}

TEST(ServoRests, BeginASecondAfterItsSpeedIsZero) {
  EXPECT_EQ(rests_of("mmmmm" + std::string(21, 'h') + "mm"), (Rests{{1500, 2500}}));
}

TEST(ServoRests, AreThoseOfADisarmedServoAsWell) {
  EXPECT_EQ(rests_of(std::string(10, 'h') + std::string(11, 'd')), (Rests{{1000, 2000}}));
}

TEST(ServoRests, OfASecondOrLessAreNone) {
  EXPECT_EQ(rests_of(std::string(11, 'h')), Rests{});
  EXPECT_EQ(rests_of(std::string(12, 'h')), (Rests{{1000, 1100}}));
}

TEST(ServoRests, EndWithTheFirstMessageThatMoves) {
  EXPECT_EQ(rests_of(std::string(15, 'h') + "m" + std::string(10, 'h') + "c" + std::string(13, 'h')),
            (Rests{{1000, 1400}, {3700, 3900}}));
}

TEST(ServoRests, OfNoMessagesAreNone) {
  EXPECT_EQ(rests_of(""), Rests{});
  EXPECT_EQ(rests_of("mmmmmmmmmmmmmmmmmmmm"), Rests{});
}

}  // namespace
}  // namespace thermorig::session
