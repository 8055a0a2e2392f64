// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "thermorig/core/frame.h"

namespace thermorig::dataset {

/// Frames (n, 24, 32) in as few bits as each row of them needs: whole hundredths of a degree, which is what
/// cameras send, as what they are above the row's coldest pixel; a row with any other value as it is.
struct PackedFrames {
  std::vector<std::byte> bytes;
  std::vector<std::uint64_t> begin;  // (n + 1) of each frame in `bytes`, and of the end

  std::uint64_t size() const { return bytes.size() + begin.size() * sizeof(begin.front()); }
};

/// At most, of one frame.
constexpr std::size_t packed_frame_bytes = frame_rows * (frame_columns * sizeof(float) + 3);

PackedFrames pack_frames(std::span<const float> temp_c);

/// As many frames as fill `temp_c`, bit for bit as they were, from the first of them on.
void unpack_frames(const std::byte* packed, std::span<float> temp_c);

}  // namespace thermorig::dataset
