// SPDX-License-Identifier: MIT
#include "rig/recording/device_presence.h"

#include <gmock/gmock.h>

#include "support/at_s.h"

namespace thermorig::rig::test {
namespace {

using ::testing::HasSubstr;

const Error unplugged(ExitCode::device_lost, "unplugged", "gyro", "look at its cable");

DevicePresence gyro() {
  return {Device::gyro, RigProfile{}, 60.0};
}

TEST(DevicePresence, IsBackAfterAsManyGoodMessagesAsNoiseDoesNotGive) {
  DevicePresence one = gyro();
  for (int i = 0; i < 100; ++i) one.message();
  one.lose_port();
  one.await(unplugged, at_s(10.0));
  for (int i = 0; i < 20; ++i) one.message();
  EXPECT_FALSE(one.is_back()) << "without a port";
  one.open_port(at_s(12.0));
  for (int i = 0; i < 19; ++i) one.message();
  EXPECT_FALSE(one.is_back());
  one.message();
  EXPECT_TRUE(one.is_back());
  EXPECT_EQ(one.come_back(), at_s(10.0));
  EXPECT_TRUE(one.is_there());
}

TEST(DevicePresence, EndsTheRecordingWhenThePatienceIsOver) {
  DevicePresence one = gyro();
  EXPECT_FALSE(one.verdict(at_s(1000.0))) << "it is there";
  one.await(unplugged, at_s(10.0));
  EXPECT_EQ(one.awaited(at_s(15.0))->left_s, 55.0);
  EXPECT_FALSE(one.verdict(at_s(69.9)));
  ASSERT_TRUE(one.verdict(at_s(70.0)));
  EXPECT_EQ(one.verdict(at_s(70.0))->what_happened(), "unplugged, and it did not come back within 60 s");
}

TEST(DevicePresence, SaysThatWhatCameWasNotEnough) {
  DevicePresence one = gyro();
  one.await(unplugged, at_s(10.0));
  one.received(std::vector<std::uint8_t>(10'000), at_s(11.0));
  EXPECT_THAT(one.verdict(at_s(70.0))->what_happened(),
              HasSubstr("10000 bytes came, with too few messages of the gyro"));
}

TEST(DevicePresence, DoneWithoutIsNotAwaited) {
  DevicePresence one = gyro();
  one.lose_port();
  one.do_without();
  EXPECT_FALSE(one.awaited(at_s(10.0)));
  EXPECT_FALSE(one.verdict(at_s(1000.0)));
  one.open_port(at_s(20.0));
  for (int i = 0; i < 20; ++i) one.message();
  EXPECT_TRUE(one.is_back());
  one.come_back();
  EXPECT_TRUE(one.was_done_without());
}

TEST(DevicePresence, ForgoneAtTheEndItsPortIsNotLookedFor) {
  DevicePresence one = gyro();
  one.lose_port();
  one.forgo();
  EXPECT_TRUE(one.has_port());
  EXPECT_TRUE(one.is_done_without());
  EXPECT_FALSE(one.was_done_without());
}

}  // namespace
}  // namespace thermorig::rig::test
