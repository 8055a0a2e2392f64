// SPDX-License-Identifier: MIT
#include "chunk_decoder.h"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <new>

#include "chunk_codec.h"

namespace thermorig::session {

namespace {

using Filters = std::vector<H5Z_filter_t>;

Filters filters_of(hid_t dataset) {
  const Handle properties(H5Dget_create_plist(dataset), "read the filters");
  Filters filters;
  for (int i = 0; i < H5Pget_nfilters(properties.get()); ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    filters.push_back(H5Pget_filter2(properties.get(), static_cast<unsigned>(i), &flags, &values, nullptr, 0,
                                     nullptr, &config));
  }
  return filters;
}

/// How many bytes of an element were put apart: 1 where they were left as they are, 0 where the filters are
/// others.
std::size_t shuffled_bytes(hid_t dataset) {
  const Filters filters = filters_of(dataset);
  if (filters == Filters{H5Z_FILTER_DEFLATE, H5Z_FILTER_FLETCHER32}) return 1;
  if (filters != Filters{H5Z_FILTER_SHUFFLE, H5Z_FILTER_DEFLATE, H5Z_FILTER_FLETCHER32}) return 0;
  const Handle type(H5Dget_type(dataset), "read the type");
  return H5Tget_size(type.get());
}

template <std::size_t element_bytes>
void join_elements(const std::byte* in, std::size_t apart, std::size_t count, std::byte* out) {
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < element_bytes; ++j) out[i * element_bytes + j] = in[j * apart + i];
}

}  // namespace

void ChunkDecoder::Free::operator()(libdeflate_decompressor* decompressor) const {
  libdeflate_free_decompressor(decompressor);
}

ChunkDecoder::ChunkDecoder(hid_t dataset, std::span<const hsize_t> dims, std::span<const hsize_t> chunk,
                           std::size_t row_bytes)
    : dataset_(dataset), chunk_rows_(chunk.front()), row_bytes_(row_bytes) {
  if (chunk.size() != dims.size() || !std::equal(dims.begin() + 1, dims.end(), chunk.begin() + 1)) return;
  const std::size_t bytes = shuffled_bytes(dataset);
  if (bytes != 1 && bytes != 2 && bytes != 4 && bytes != 8) return;
  decompressor_.reset(libdeflate_alloc_decompressor());
  if (decompressor_ == nullptr) throw std::bad_alloc();
  element_bytes_ = bytes;
  inflated_.resize(chunk_rows_ * row_bytes_);
}

/// Into inflated_.
bool ChunkDecoder::fetch(hsize_t first) {
  std::array<hsize_t, H5S_MAX_RANK> offset{first};
  hsize_t size = 0;
  std::uint32_t mask = 0, sum = 0;
  if (H5Dget_chunk_storage_size(dataset_, offset.data(), &size) < 0) return false;
  if (size <= sizeof sum || size > 2 * inflated_.size() + 1024) return false;
  stored_.resize(size);
  if (H5Dread_chunk(dataset_, H5P_DEFAULT, offset.data(), &mask, stored_.data()) < 0 || mask != 0)
    return false;
  const auto compressed = std::span(stored_).first(size - sizeof sum);
  std::memcpy(&sum, stored_.data() + compressed.size(), sizeof sum);
  return fletcher32(compressed) == sum &&
         libdeflate_zlib_decompress(decompressor_.get(), compressed.data(), compressed.size(),
                                    inflated_.data(), inflated_.size(), nullptr) == LIBDEFLATE_SUCCESS;
}

void ChunkDecoder::unshuffle(std::size_t bytes, std::byte* out) const {
  const std::size_t apart = inflated_.size() / element_bytes_, count = bytes / element_bytes_;
  if (element_bytes_ == 2) return join_elements<2>(inflated_.data(), apart, count, out);
  if (element_bytes_ == 4) return join_elements<4>(inflated_.data(), apart, count, out);
  if (element_bytes_ == 8) return join_elements<8>(inflated_.data(), apart, count, out);
  std::memcpy(out, inflated_.data(), bytes);
}

bool ChunkDecoder::read(hsize_t first, hsize_t rows, std::byte* out) {
  if (element_bytes_ == 0 || first % chunk_rows_ != 0 || rows > chunk_rows_ || !fetch(first)) return false;
  unshuffle(rows * row_bytes_, out);
  return true;
}

}  // namespace thermorig::session
