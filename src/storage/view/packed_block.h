// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace thermorig::view {

inline constexpr std::size_t packed_images = 64;  // of a block

/// What stands for a pixel that is not a number.
inline constexpr unsigned char no_code = 255;

/// Images with a byte a pixel: least temperature and step in degC as two little-endian 32-bit floats, then
/// the codes of each image less those of the one before (modulo 256), of the first as they are. A pixel is
/// least + code * step, within half a step; the steps are as fine as the block's range allows, and a
/// hundredth at least. `images`: image_bytes each, packed_images at most.
std::string packed_block(std::string_view images);

}  // namespace thermorig::view
