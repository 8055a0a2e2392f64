// SPDX-License-Identifier: MIT
// Seeded damage to streams of camera frames: what is far enough from it is recovered, nothing is made up.
#include <gtest/gtest.h>

#include <random>

#include "camera_stream.h"

namespace thermorig::test {
namespace {

constexpr std::size_t frames_sent = 12;

/// A stream, and which of its frames came through untouched.
struct DamagedStream {
  ByteVector bytes;
  std::vector<ThermalFrame> intact;
  std::size_t gaps = 0;
};

ByteVector damaged_frame(const ByteVector& frame, std::mt19937_64& random) {
  ByteVector bytes = frame;
  const std::size_t at = random() % bytes.size();
  const auto where = bytes.begin() + static_cast<std::ptrdiff_t>(at);
  const auto until = static_cast<std::ptrdiff_t>(std::min(bytes.size(), at + 1 + random() % 300));
  switch (random() % 4) {
    case 0:  // flipped
      bytes[at] ^= static_cast<std::uint8_t>(1U << (random() % 8));
      break;
    case 1:  // lost
      bytes.erase(where, bytes.begin() + until);
      break;
    case 2: {  // doubled
      const ByteVector again(where, bytes.begin() + until);
      bytes.insert(where, again.begin(), again.end());
      break;
    }
    default: {  // garbage put in
      const ByteVector garbage = random_bytes(1 + random() % 300, random());
      bytes.insert(where, garbage.begin(), garbage.end());
    }
  }
  return bytes;
}

DamagedStream damaged_stream(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  DamagedStream stream;
  for (std::size_t i = 0; i < frames_sent; ++i) {
    const ThermalFrame frame = frame_of_noise(100 * seed + i);
    const ByteVector bytes = wire::camera_frame(frame);
    const ByteVector sent = random() % 3 == 0 ? damaged_frame(bytes, random) : bytes;
    append(stream.bytes, sent);
    if (sent == bytes)
      stream.intact.push_back(frame);
    else
      ++stream.gaps;
  }
  return stream;
}

bool is_among(const ThermalFrame& frame, const std::vector<ThermalFrame>& frames) {
  return std::any_of(frames.begin(), frames.end(),
                     [&](const ThermalFrame& other) { return same_frame(frame, other); });
}

class DamagedCamera : public testing::TestWithParam<std::uint64_t> {};

TEST_P(DamagedCamera, GivesEveryIntactFrameAndNoOther) {
  DamagedStream stream = damaged_stream(GetParam());
  const ThermalFrame last = frame_of_noise(7);
  for (int i = 0; i < 2; ++i) append(stream.bytes, wire::camera_frame(last));  // flushes what waits
  const auto scan = scan_camera(stream.bytes);
  for (const ThermalFrame& frame : stream.intact) {
    const auto found = std::any_of(scan.messages.begin(), scan.messages.end(),
                                   [&](const auto& message) { return same_frame(message.frame, frame); });
    EXPECT_TRUE(found);
  }
  // Doubling or inserting behind a frame's last byte leaves the frame itself good, so it may be among them.
  std::vector<ThermalFrame> sent{last};
  for (std::size_t i = 0; i < frames_sent; ++i) sent.push_back(frame_of_noise(100 * GetParam() + i));
  for (const auto& message : scan.messages) EXPECT_TRUE(is_among(message.frame, sent));
  EXPECT_EQ(scan.counters.bytes_in_damaged + scan.counters.bytes_skipped > 0, stream.gaps > 0);
}

TEST_P(DamagedCamera, FindsNothingInNoise) {
  const auto scan = scan_camera(random_bytes(50000, GetParam()));
  EXPECT_TRUE(scan.messages.empty());
  EXPECT_LT(scan.counters.bytes_pending, wire::camera_frame_bytes + gy_mcu90640::reply_bytes);
}

INSTANTIATE_TEST_SUITE_P(Seeds, DamagedCamera, testing::Range<std::uint64_t>(1, 41));

}  // namespace
}  // namespace thermorig::test
