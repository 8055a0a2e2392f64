// SPDX-License-Identifier: MIT
#include "sha256.h"

#include <sha2.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include "thermorig/core/error.h"

namespace thermorig::publication {

std::string sha256_of_file(const std::filesystem::path& path) {
  std::array<char, SHA256_DIGEST_STRING_LENGTH> digits{};
  if (SHA256File(path.c_str(), digits.data()) != nullptr) return digits.data();
  throw Error(ExitCode::storage, std::string("cannot be read: ") + std::strerror(errno), path.string(),
              "check its permissions, and the disk (dmesg)");
}

std::string sha256_of(std::string_view text) {
  std::array<char, SHA256_DIGEST_STRING_LENGTH> digits{};
  SHA256Data(reinterpret_cast<const std::uint8_t*>(text.data()), text.size(), digits.data());
  return digits.data();
}

}  // namespace thermorig::publication
