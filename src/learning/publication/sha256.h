// SPDX-License-Identifier: MIT
#pragma once

#include <sha2.h>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace thermorig::publication {

/// SHA-256 of what is added, one part after another.
class Sha256 {
 public:
  Sha256() { SHA256Init(&state_); }
  void add(std::span<const std::byte> bytes);
  std::string hexadecimal();

 private:
  SHA2_CTX state_{};
};

std::string sha256_of(std::span<const std::byte> bytes);
std::string sha256_of(std::string_view text);

}  // namespace thermorig::publication
