// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "thermorig/core/frame.h"

namespace thermorig {

/// What a page is sent of an image: two bytes a pixel.
inline constexpr std::size_t image_bytes = 2 * frame_pixels;

/// Appends hundredths of a degree as a little-endian 16-bit number, held within its range; what is not a
/// number becomes the lowest one, -32768.
void append_hundredths(std::vector<std::uint8_t>& bytes, float temp_c);

/// The same of all pixels, rows from the top, the scene's left on the left: image_bytes in all.
void append_image(std::vector<std::uint8_t>& bytes, const ThermalFrame& frame, bool mirrored);

}  // namespace thermorig
