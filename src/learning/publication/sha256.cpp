// SPDX-License-Identifier: MIT
#include "sha256.h"

#include <array>
#include <cstdint>

namespace thermorig::publication {

void Sha256::add(std::span<const std::byte> bytes) {
  SHA256Update(&state_, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

std::string Sha256::hexadecimal() {
  std::array<char, SHA256_DIGEST_STRING_LENGTH> digits{};
  SHA256End(&state_, digits.data());
  return digits.data();
}

std::string sha256_of(std::span<const std::byte> bytes) {
  Sha256 sum;
  sum.add(bytes);
  return sum.hexadecimal();
}

std::string sha256_of(std::string_view text) {
  return sha256_of(std::as_bytes(std::span(text)));
}

}  // namespace thermorig::publication
