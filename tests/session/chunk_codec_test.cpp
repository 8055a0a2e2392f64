// SPDX-License-Identifier: MIT
#include "storage/session/chunk_codec.h"

#include <gtest/gtest.h>

#include <cstring>

namespace thermorig::session {
namespace {

std::vector<std::byte> bytes_of(const char* text) {
  std::vector<std::byte> bytes(std::strlen(text));
  std::memcpy(bytes.data(), text, bytes.size());
  return bytes;
}

// Values of Fletcher-32 over big-endian words, worked by hand: sums of words, modulo 65535.
TEST(Fletcher32, SumsBigEndianWords) {
  EXPECT_EQ(fletcher32(bytes_of("\x01\x02")), 0x01020102U);
  EXPECT_EQ(fletcher32(bytes_of("\x01\x02\x03\x04")), 0x05080406U);
  EXPECT_EQ(fletcher32(bytes_of("\x01\x02\x03")), 0x05040402U);
}

TEST(Fletcher32, FoldsLongInputsWithoutOverflow) {
  const std::vector<std::byte> ones(100'000, std::byte{0xFF});
  EXPECT_EQ(fletcher32(ones), 0xFFFFFFFFU);
}

TEST(Shuffle, PutsEqualPlacesOfElementsTogether) {
  std::vector<std::byte> out(8);
  shuffle(bytes_of("AaBbCcDd"), 2, out);
  EXPECT_EQ(out, bytes_of("ABCDabcd"));
  shuffle(bytes_of("AbcdEfgh"), 4, out);
  EXPECT_EQ(out, bytes_of("AEbfcgdh"));
}

TEST(ChunkCodec, GivesTheSameBytesEachTime) {
  ChunkCodec codec, other;
  const std::vector<std::byte> chunk(4096, std::byte{7});
  const auto first = codec.encode(chunk, 4);
  codec.encode(bytes_of("something between"), 1);
  EXPECT_EQ(codec.encode(chunk, 4), first);
  EXPECT_EQ(other.encode(chunk, 4), first);
  EXPECT_LT(first.size(), 100U);
}

}  // namespace
}  // namespace thermorig::session
