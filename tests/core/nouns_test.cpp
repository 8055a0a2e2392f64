// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <limits>

#include "thermorig/core/device.h"
#include "thermorig/core/frame.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"

namespace thermorig::test {
namespace {

TEST(Time, RoundsSecondsToTheNearestNanosecond) {
  EXPECT_EQ(from_s(1.2345678904e0).count(), 1234567890);
  EXPECT_EQ(from_s(-0.0000000006).count(), -1);
  EXPECT_EQ(from_s(0.0000000004).count(), 0);
  EXPECT_DOUBLE_EQ(to_s(from_s(-12.5)), -12.5);
  EXPECT_DOUBLE_EQ(to_s(from_s(1e300)), 4e9);
  EXPECT_DOUBLE_EQ(to_s(from_s(-std::numeric_limits<double>::infinity())), -4e9);
  EXPECT_EQ(from_s(std::numeric_limits<double>::quiet_NaN()).count(), 0);
}

TEST(Frame, SubpagesAreAChessboard) {
  int odd = 0;
  for (std::size_t row = 0; row < frame_rows; ++row)
    for (std::size_t column = 0; column < frame_columns; ++column) {
      EXPECT_EQ(subpage_of(row, column), (row + column) % 2);
      odd += static_cast<int>(subpage_of(row, column));
    }
  EXPECT_EQ(odd, static_cast<int>(frame_pixels) / 2);
}

TEST(RigProfile, FindsTheLinkOfEachDevice) {
  RigProfile profile;
  for (const Device device : all_devices) profile.link(device).port = std::string(name_of(device));
  EXPECT_EQ(profile.camera.link.port, "camera");
  EXPECT_EQ(profile.gyro.link.port, "gyro");
  EXPECT_EQ(profile.servo.link.port, "servo");
}

TEST(PerDevice, KeepsOneValueForEach) {
  PerDevice<int> numbers;
  for (const Device device : all_devices) numbers[device] = static_cast<int>(index_of(device)) + 1;
  EXPECT_EQ(numbers[Device::camera], 1);
  EXPECT_EQ(numbers[Device::servo], 3);
}

TEST(LabelledSample, NamesTheLowestReasonFirst) {
  LabelledSample sample;
  EXPECT_EQ(sample.first_reason(), 0);
  sample.reason_bits = 0b1010;
  EXPECT_EQ(sample.first_reason(), 2);
  sample.reason_bits = 1U << 31;
  EXPECT_EQ(sample.first_reason(), 32);
}

}  // namespace
}  // namespace thermorig::test
