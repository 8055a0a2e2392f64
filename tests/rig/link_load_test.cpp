// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/expected_size.h"

#include <gtest/gtest.h>

namespace thermorig::rig {
namespace {

TEST(LinkLoad, IsThatOfTheDefaultRig) {
  const RigProfile profile;
  EXPECT_DOUBLE_EQ(link_load(Device::camera, profile).bytes_per_s(), 1544 * 8.0);
  EXPECT_DOUBLE_EQ(link_load(Device::gyro, profile).bytes_per_s(), 11 * 200.0);
  EXPECT_DOUBLE_EQ(link_load(Device::servo, profile).rate_hz, 100.0);
}

TEST(LinkLoad, OfATextGyroGrowsWithItsColumns) {
  RigProfile profile;
  profile.gyro.protocol = "text";
  const auto three_columns = link_load(Device::gyro, profile).message_bytes;
  EXPECT_GT(three_columns, 20U);
  profile.gyro.text.prefix = "a/g:";
  profile.gyro.text.rate = {4, 5, 6};
  EXPECT_EQ(link_load(Device::gyro, profile).message_bytes, three_columns + 4 * 8 + 4);
}

TEST(LinkLoad, OfAFlightControllerIsThatOfTheMessageItIsToSend) {
  RigProfile profile;
  profile.gyro.protocol = "mavlink";
  EXPECT_EQ(link_load(Device::gyro, profile).message_bytes, 10U + 24 + 2);
  profile.gyro.settings = {{"message", 105.0}};
  EXPECT_EQ(link_load(Device::gyro, profile).message_bytes, 10U + 63 + 2);
}

}  // namespace
}  // namespace thermorig::rig
