// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

struct libdeflate_compressor;

namespace thermorig::session {

/// The filter pipeline shuffle + deflate (level 4) + fletcher32 over one chunk, giving the bytes that stock
/// HDF5 reads back. Done here because the library filters one chunk at a time on one core, with zlib. The
/// output depends on the input alone. One object a thread.
class ChunkCodec {
 public:
  static constexpr int deflate_level = 4;

  ChunkCodec();
  ~ChunkCodec();
  ChunkCodec(const ChunkCodec&) = delete;
  ChunkCodec& operator=(const ChunkCodec&) = delete;

  /// `element_bytes` 1 is not shuffled. Throws std::bad_alloc only.
  std::vector<std::byte> encode(std::span<const std::byte> chunk, std::size_t element_bytes);

 private:
  libdeflate_compressor* compressor_;
  std::vector<std::byte> shuffled_;  // kept from chunk to chunk
  std::vector<std::byte> compressed_;
};

/// Byte j of all elements stands together, for each j (HDF5's shuffle filter).
void shuffle(std::span<const std::byte> in, std::size_t element_bytes, std::span<std::byte> out);

/// HDF5's variant of Fletcher's checksum: big-endian 16-bit words. Source: H5_checksum_fletcher32.
std::uint32_t fletcher32(std::span<const std::byte> bytes);

}  // namespace thermorig::session
