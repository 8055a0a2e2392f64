// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "hdf5_handle.h"

struct libdeflate_decompressor;

namespace thermorig::session {

/// Undoes what ChunkCodec does, several times as fast as the library. Whatever is not just so - other
/// filters, a check sum that does not fit, bytes that are too few or too many - is left to the library, which
/// reads it or says what is wrong with it.
class ChunkDecoder {
 public:
  /// Of a dataset whose `row_bytes` lie together: a chunk is whole rows.
  ChunkDecoder(hid_t dataset, std::span<const hsize_t> dims, std::span<const hsize_t> chunk,
               std::size_t row_bytes);

  /// The first `rows` of the chunk that begins at row `first`. False: nothing was read.
  bool read(hsize_t first, hsize_t rows, std::byte* out);

 private:
  bool fetch(hsize_t first);
  void unshuffle(std::size_t bytes, std::byte* out) const;

  struct Free {
    void operator()(libdeflate_decompressor* decompressor) const;
  };
  hid_t dataset_;
  hsize_t chunk_rows_;
  std::size_t row_bytes_;
  std::size_t element_bytes_ = 0;  // that are shuffled; 0: not our filters
  std::unique_ptr<libdeflate_decompressor, Free> decompressor_;
  std::vector<std::byte> stored_;  // kept from chunk to chunk
  std::vector<std::byte> inflated_;
};

}  // namespace thermorig::session
