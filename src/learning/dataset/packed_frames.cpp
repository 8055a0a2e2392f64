// SPDX-License-Identifier: MIT
#include "packed_frames.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace thermorig::dataset {

namespace {

using Words = std::array<std::uint32_t, frame_columns>;
constexpr unsigned word_bits = 32;
static_assert(frame_columns == word_bits, "a row of so many bits a pixel takes as many words");

/// What stands before the pixels of a frame: of each row.
struct Header {
  std::array<std::int16_t, frame_rows> coldest;  // in hundredths of a degree
  std::array<std::uint8_t, frame_rows> bits;     // a pixel; 32 where they are floats
};
static_assert(sizeof(Header) == 3 * frame_rows);

float temp_c_of(int hundredths) {
  return static_cast<float>(hundredths) / 100.0F;
}

/// Whether no bit is lost.
bool to_hundredths(std::span<const float> temp_c, std::span<int> hundredths) {
  constexpr float most = std::numeric_limits<std::int16_t>::max() + 0.25F;  // scaling has rounded
  for (std::size_t i = 0; i < temp_c.size(); ++i) {
    const float scaled = temp_c[i] * 100.0F;
    if (!(std::abs(scaled) <= most)) return false;
    hundredths[i] = static_cast<int>(std::lrint(scaled));
    if (std::bit_cast<std::uint32_t>(temp_c_of(hundredths[i])) != std::bit_cast<std::uint32_t>(temp_c[i]))
      return false;
  }
  return true;
}

struct PackedRow {
  std::int16_t coldest = 0;
  std::uint8_t bits = word_bits;
  Words words;  // as many as bits
};

PackedRow pack_row(std::span<const float> temp_c) {
  PackedRow row;
  std::array<int, frame_columns> hundredths{};
  if (!to_hundredths(temp_c, hundredths)) {
    std::memcpy(row.words.data(), temp_c.data(), sizeof(row.words));
    return row;
  }
  const auto [coldest, warmest] = std::minmax_element(hundredths.begin(), hundredths.end());
  row.coldest = static_cast<std::int16_t>(*coldest);
  row.bits = static_cast<std::uint8_t>(std::bit_width(static_cast<unsigned>(*warmest - *coldest)));
  row.words.fill(0);
  for (std::size_t i = 0; i < frame_columns; ++i) {
    const std::uint64_t above = static_cast<std::uint64_t>(hundredths[i] - row.coldest);
    const std::size_t bit = i * row.bits, word = bit / word_bits;
    const std::uint64_t placed = above << (bit % word_bits);
    row.words[word] |= static_cast<std::uint32_t>(placed);
    if (placed >> word_bits != 0) row.words[word + 1] |= static_cast<std::uint32_t>(placed >> word_bits);
  }
  return row;
}

template <unsigned bits, std::size_t i>
std::uint32_t above_coldest(const std::uint32_t* words) {
  constexpr std::size_t word = i * bits / word_bits;
  constexpr unsigned shift = i * bits % word_bits;
  std::uint32_t value = words[word] >> shift;
  if constexpr (shift + bits > word_bits) value |= words[word + 1] << (word_bits - shift);
  return value & ((1U << bits) - 1);
}

/// For each number of bits one of its own: that all shifts are constants makes it several times as fast.
template <unsigned bits>
void unpack_row(const std::byte* packed, int coldest, float* temp_c) {
  std::array<std::uint32_t, bits> words;
  std::memcpy(words.data(), packed, sizeof(words));
  std::array<int, frame_columns> hundredths;
  [&]<std::size_t... i>(std::index_sequence<i...>) {
    ((hundredths[i] = coldest + static_cast<int>(above_coldest<bits, i>(words.data()))), ...);
  }
  (std::make_index_sequence<frame_columns>());
  std::transform(hundredths.begin(), hundredths.end(), temp_c, temp_c_of);
}

template <>
void unpack_row<0>(const std::byte*, int coldest, float* temp_c) {
  std::fill_n(temp_c, frame_columns, temp_c_of(coldest));
}

using UnpackRow = void (*)(const std::byte* packed, int coldest, float* temp_c);
constexpr auto unpack_with_bits = []<unsigned... bits>(std::integer_sequence<unsigned, bits...>) {
  return std::array<UnpackRow, sizeof...(bits)>{&unpack_row<bits>...};
}
(std::make_integer_sequence<unsigned, 17>());

void append(std::vector<std::byte>& bytes, const void* from, std::size_t count) {
  const auto* const begin = static_cast<const std::byte*>(from);
  bytes.insert(bytes.end(), begin, begin + count);
}

void pack_frame(std::span<const float> temp_c, std::vector<std::byte>& bytes) {
  Header header;
  const std::size_t begin = bytes.size();
  append(bytes, &header, sizeof(header));  // its room
  for (std::size_t i = 0; i < frame_rows; ++i) {
    const PackedRow row = pack_row(temp_c.subspan(i * frame_columns, frame_columns));
    header.coldest[i] = row.coldest;
    header.bits[i] = row.bits;
    append(bytes, row.words.data(), row.bits * sizeof(row.words.front()));
  }
  std::memcpy(&bytes[begin], &header, sizeof(header));
}

/// Returns the end of the frame's bytes.
const std::byte* unpack_frame(const std::byte* packed, float* temp_c) {
  Header header;
  std::memcpy(&header, packed, sizeof(header));
  packed += sizeof(header);
  for (std::size_t i = 0; i < frame_rows; ++i, temp_c += frame_columns) {
    const std::size_t bytes = header.bits[i] * sizeof(std::uint32_t);
    if (header.bits[i] == word_bits)
      std::memcpy(temp_c, packed, bytes);
    else
      unpack_with_bits[header.bits[i]](packed, header.coldest[i], temp_c);
    packed += bytes;
  }
  return packed;
}

}  // namespace

PackedFrames pack_frames(std::span<const float> temp_c) {
  PackedFrames packed;
  packed.bytes.reserve(temp_c.size() * sizeof(float) / 2);
  packed.begin.push_back(0);
  for (; !temp_c.empty(); temp_c = temp_c.subspan(frame_pixels)) {
    pack_frame(temp_c.first(frame_pixels), packed.bytes);
    packed.begin.push_back(packed.bytes.size());
  }
  packed.bytes.shrink_to_fit();
  return packed;
}

void unpack_frames(const std::byte* packed, std::span<float> temp_c) {
  for (; !temp_c.empty(); temp_c = temp_c.subspan(frame_pixels)) packed = unpack_frame(packed, temp_c.data());
}

}  // namespace thermorig::dataset
