// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

namespace thermorig::test {

using ByteVector = std::vector<std::uint8_t>;
using ByteSpan = std::span<const std::uint8_t>;

/// `bytes` in pieces of `size`; the last one may be shorter.
inline std::vector<ByteSpan> even_chunks(ByteSpan bytes, std::size_t size) {
  std::vector<ByteSpan> chunks;
  for (std::size_t at = 0; at < bytes.size(); at += size)
    chunks.push_back(bytes.subspan(at, std::min(size, bytes.size() - at)));
  return chunks;
}

/// `bytes` in pieces of 0 to `size_max` bytes, drawn with `seed`: short ones are as common as long ones.
inline std::vector<ByteSpan> random_chunks(ByteSpan bytes, std::size_t size_max, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<ByteSpan> chunks;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t bound = 1 + random() % size_max;
    const std::size_t size = std::min(random() % (bound + 1), bytes.size() - at);
    chunks.push_back(bytes.subspan(at, size));
    at += size;
  }
  return chunks;
}

inline void append(ByteVector& bytes, ByteSpan more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

inline ByteVector random_bytes(std::size_t size, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  ByteVector bytes(size);
  for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
  return bytes;
}

}  // namespace thermorig::test
