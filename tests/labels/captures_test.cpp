// SPDX-License-Identifier: MIT
// Which chess half is fresh, in frames of real sensors.
#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "support/captures.h"
#include "thermorig/core/profile.h"
#include "thermorig/pipeline/labels/exposure.h"
#include "thermorig/sensors/wire/camera_scanner.h"

namespace thermorig::labels {
namespace {

constexpr double captured_period_s = 0.125;

/// Which halves are fresh, a letter a frame: 'E'ven, 'O'dd, 'B'oth, 'N'one; lower case where it is stale.
std::string fresh_halves(const std::vector<Freshness>& frames, CameraMode* mode) {
  ExposureRule rule(captured_period_s);
  std::string result;
  HostTime time{};
  for (const Freshness& fresh : frames) {
    TimedFrame timed;
    timed.fresh_even = fresh.even;
    timed.fresh_odd = fresh.odd;
    timed.stamp.time = time += from_s(captured_period_s);
    rule.apply(timed);
    const char letter = fresh.both_fresh() ? 'B' : fresh.none_fresh() ? 'N' : fresh.even_fresh() ? 'E' : 'O';
    result += static_cast<char>(timed.stale ? letter + ('a' - 'A') : letter);
  }
  *mode = rule.mode();
  return result;
}

TEST(RealFrames, OfTheSerialBridgeAreFoundFullFresh) {
  const auto bytes = test::read_capture("gy_mcu90640_serial/roasted-duck.bin");
  if (!bytes) GTEST_SKIP() << "no captures on this machine";
  wire::CameraScanner scanner(ChecksumPolicy::word);
  std::vector<wire::CameraMessage> messages;
  scanner.push(*bytes, messages);
  std::vector<Freshness> frames;
  for (const wire::CameraMessage& message : messages) frames.push_back(message.fresh);
  ASSERT_EQ(frames.size(), 128U);
  CameraMode mode{};
  EXPECT_EQ(fresh_halves(frames, &mode), std::string(128, 'B'));
  EXPECT_EQ(mode, CameraMode::full_fresh);
}

TEST(RealFrames, OfOneSubpageAFrameAreFoundHalfFreshAndAlternating) {
  const auto bytes = test::read_capture("mlx90640_float_frames/static-scene-500-frames.f32");
  if (!bytes) GTEST_SKIP() << "no captures on this machine";
  std::vector<Freshness> frames;
  FreshnessDetector<float> detector;
  std::array<float, frame_pixels> pixels{};
  for (std::size_t at = 0; at + sizeof pixels <= bytes->size(); at += sizeof pixels) {
    std::memcpy(pixels.data(), bytes->data() + at, sizeof pixels);
    frames.push_back(detector.push(pixels));
  }
  ASSERT_EQ(frames.size(), 500U);
  CameraMode mode{};
  const std::string halves = fresh_halves(frames, &mode);
  EXPECT_EQ(mode, CameraMode::half_fresh);
  const char second = halves.at(1);
  EXPECT_TRUE(second == 'E' || second == 'O');
  for (std::size_t i = 1; i < halves.size(); ++i)
    EXPECT_EQ(halves[i], i % 2 == 1 ? second : second == 'E' ? 'O' : 'E') << i;
}

}  // namespace
}  // namespace thermorig::labels
