// SPDX-License-Identifier: MIT
#include "fingerprint.h"

#include <sha2.h>

#include <algorithm>
#include <array>
#include <vector>

namespace thermorig::study {

std::string fingerprint_of(const std::string& text) {
  std::array<char, SHA256_DIGEST_STRING_LENGTH> digits{};
  SHA256Data(reinterpret_cast<const std::uint8_t*>(text.data()), text.size(), digits.data());
  return digits.data();
}

std::string fingerprint_of(std::span<const network::Acquisition> acquisitions) {
  std::vector<std::string> hashes;
  for (const network::Acquisition& acquisition : acquisitions) hashes.push_back(acquisition.learnt_hash());
  std::sort(hashes.begin(), hashes.end());
  std::string text;
  for (const std::string& hash : hashes) text += hash + "\n";
  return fingerprint_of(text);
}

}  // namespace thermorig::study
