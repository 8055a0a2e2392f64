// SPDX-License-Identifier: MIT
#include "thermorig/network/stored_frames.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <memory>

#include "thermorig/core/frame.h"
#include "thermorig/network/acquisition.h"

namespace thermorig::network {
namespace {

/// So many frames of whole hundredths of a degree, as cameras send them, from the coldest to the warmest
/// there are.
std::vector<float> hundredths(std::size_t frames) {
  std::vector<float> temp_c;
  for (std::size_t i = 0; i < frames * frame_pixels; ++i) {
    const int between = static_cast<int>(i * 7919 % 65535) - 32767;
    const std::size_t column = i % frame_columns;
    temp_c.push_back(static_cast<float>(column == 3 ? -32767 : column == 30 ? 32767 : between) / 100.0F);
  }
  return temp_c;
}

/// The same with one pixel that is none.
std::vector<float> not_hundredths(std::size_t frames, float odd = 20.001F) {
  std::vector<float> temp_c = hundredths(frames);
  temp_c[5] = odd;
  return temp_c;
}

TEST(PackedFrames, TakeHalfOfTheRoom) {
  EXPECT_EQ(PackedFrames(hundredths(3)).bytes(), 3 * frame_pixels * 2);
}

TEST(PackedFrames, AreFloatsWhereABitWouldBeLost) {
  for (const float odd : {20.001F, -0.0F, 400.0F, std::numeric_limits<float>::quiet_NaN()})
    EXPECT_EQ(PackedFrames(not_hundredths(2, odd)).bytes(), 2 * frame_pixels * sizeof(float)) << odd;
}

TEST(PackedFrames, GiveBackTheSameBits) {
  for (const std::vector<float>& before : {hundredths(70), not_hundredths(70)}) {
    Acquisition acquisition;
    acquisition.run.resize(70, 1);
    acquisition.packed = std::make_shared<PackedFrames>(before);
    std::size_t frames = 0;
    for_each_frame(acquisition, [&](std::size_t frame, std::span<const float> temp_c) {
      EXPECT_EQ(frame, frames++);
      ASSERT_EQ(temp_c.size(), frame_pixels);
      EXPECT_EQ(std::memcmp(temp_c.data(), &before[frame * frame_pixels], temp_c.size_bytes()), 0) << frame;
    });
    EXPECT_EQ(frames, 70U);
  }
}

}  // namespace
}  // namespace thermorig::network
