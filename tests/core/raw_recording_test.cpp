// SPDX-License-Identifier: MIT
#include "thermorig/core/raw_recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace thermorig::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(RawStream, GivesBackTheChunksThatWereAppended) {
  RawStream stream;
  stream.append(std::vector<std::uint8_t>{1, 2, 3}, host_time_ns(10));
  stream.append(std::vector<std::uint8_t>{}, host_time_ns(20));
  stream.append(std::vector<std::uint8_t>{4}, host_time_ns(30));
  ASSERT_EQ(stream.chunk_count(), 3U);
  EXPECT_THAT(stream.chunk(0), ElementsAre(1, 2, 3));
  EXPECT_THAT(stream.chunk(1), IsEmpty());
  EXPECT_THAT(stream.chunk(2), ElementsAre(4));
  EXPECT_EQ(stream.time(2), host_time_ns(30));
}

}  // namespace
}  // namespace thermorig::test
