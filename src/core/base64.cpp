// SPDX-License-Identifier: MIT
#include "thermorig/core/base64.h"

namespace thermorig {

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t there = bytes.size() - i;
    const std::uint32_t group = static_cast<std::uint32_t>(bytes[i]) << 16U |
                                (there > 1 ? static_cast<std::uint32_t>(bytes[i + 1]) << 8U : 0U) |
                                (there > 2 ? static_cast<std::uint32_t>(bytes[i + 2]) : 0U);
    for (unsigned digit = 0; digit < 4; ++digit)
      text += digit <= there ? digits[group >> (18U - 6U * digit) & 63U] : '=';
  }
  return text;
}

}  // namespace thermorig
