// SPDX-License-Identifier: MIT
#include "chunk_codec.h"

#include <libdeflate.h>

#include <algorithm>
#include <cstring>
#include <new>

namespace thermorig::session {

namespace {

// As many words as can be summed before a 32-bit sum of sums overflows.
constexpr std::size_t words_before_overflow = 360;

std::uint32_t fold(std::uint32_t sum) {
  return (sum & 0xFFFFU) + (sum >> 16U);
}

template <std::size_t element_bytes>
void shuffle_elements(const std::byte* in, std::size_t count, std::byte* out) {
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < element_bytes; ++j) out[j * count + i] = in[i * element_bytes + j];
}

}  // namespace

ChunkCodec::ChunkCodec() : compressor_(libdeflate_alloc_compressor(deflate_level)) {
  if (compressor_ == nullptr) throw std::bad_alloc();
}

ChunkCodec::~ChunkCodec() {
  libdeflate_free_compressor(compressor_);
}

void shuffle(std::span<const std::byte> in, std::size_t element_bytes, std::span<std::byte> out) {
  const std::size_t count = in.size() / element_bytes;
  if (element_bytes == 2) return shuffle_elements<2>(in.data(), count, out.data());
  if (element_bytes == 4) return shuffle_elements<4>(in.data(), count, out.data());
  if (element_bytes == 8) return shuffle_elements<8>(in.data(), count, out.data());
  std::copy(in.begin(), in.end(), out.begin());
}

std::uint32_t fletcher32(std::span<const std::byte> bytes) {
  std::uint32_t sum1 = 0;
  std::uint32_t sum2 = 0;
  const std::size_t words = bytes.size() / 2;
  const auto* at = reinterpret_cast<const std::uint8_t*>(bytes.data());
  for (std::size_t done = 0; done < words;) {
    const std::size_t end = std::min(words, done + words_before_overflow);
    for (; done < end; ++done, at += 2) {
      sum1 += (static_cast<std::uint32_t>(at[0]) << 8U) | at[1];
      sum2 += sum1;
    }
    sum1 = fold(sum1);
    sum2 = fold(sum2);
  }
  if (bytes.size() % 2 != 0) {
    sum1 = fold(sum1 + (static_cast<std::uint32_t>(*at) << 8U));
    sum2 = fold(sum2 + sum1);
  }
  return (fold(sum2) << 16U) | fold(sum1);
}

std::vector<std::byte> ChunkCodec::encode(std::span<const std::byte> chunk, std::size_t element_bytes) {
  if (element_bytes > 1) {
    shuffled_.resize(chunk.size());
    shuffle(chunk, element_bytes, shuffled_);
    chunk = shuffled_;
  }
  compressed_.resize(libdeflate_zlib_compress_bound(compressor_, chunk.size()));
  const std::size_t size = libdeflate_zlib_compress(compressor_, chunk.data(), chunk.size(),
                                                    compressed_.data(), compressed_.size());
  const std::uint32_t sum = fletcher32(std::span(compressed_).first(size));
  std::vector<std::byte> out(size + sizeof sum);
  std::memcpy(out.data(), compressed_.data(), size);
  std::memcpy(&out[size], &sum, sizeof sum);
  return out;
}

}  // namespace thermorig::session
