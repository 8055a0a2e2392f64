// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "thermorig/core/frame.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::session {

/// How much of a frame is new, and what is missing before it.
struct FrameMarks {
  std::uint16_t fresh_even = 0;      // pixels that differ from the frame before, even chess half (0..384)
  std::uint16_t fresh_odd = 0;       // the same for the odd half
  std::uint16_t missing_before = 0;  // frames that never came between the frame before and this one
};

/// What a session says of its frames without their images: a small part of its bytes.
struct Rows {
  Session session;  // without frames, gyro, servo and pongs, clocks' tables, and the bytes of the ports
  std::vector<FrameMarks> frames;  // one a sample, same order
  std::string verdict;             // as it stands in the file; empty: it has none
  std::vector<std::string> verdict_reasons;
  bool verdict_altered = false;  // it is not as thermorig wrote it; formats before 1.3 cannot tell
};

/// Throws as read_session() does, for what it reads.
Rows read_rows(const StoredFile& file);

struct FrameRange {
  std::uint64_t first = 0, count = 0;
};
inline constexpr std::uint64_t most_images = 4096;  // at a time

struct Images {
  bool mirrored = false;  // the scene's left stands on the right
  std::vector<ThermalFrame> frames;
};

/// Images of neighbouring frames, as the sensor sent them. They are held against the check sums of their
/// chunks, not against that of all images. Throws as read_rows() does; Error(not_a_session) also for frames
/// that there are not, and for more than most_images.
Images read_images(const StoredFile& file, FrameRange range);

}  // namespace thermorig::session
