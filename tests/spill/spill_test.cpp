// SPDX-License-Identifier: MIT
#include "thermorig/io/spill/spill.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <numeric>
#include <thread>
#include <vector>

#include "session/temporary_folder.h"

namespace thermorig::spill {
namespace {

constexpr std::size_t mebibyte = 1U << 20U;
using Bytes = std::vector<std::uint8_t>;

class Spill : public session::InTemporaryFolder {
 protected:
  void SetUp() override {
    InTemporaryFolder::SetUp();
    arrays_near(path(), {.array_bytes = mebibyte, .in_memory_bytes = 4 * mebibyte});
  }
};

TEST_F(Spill, PutsLargeArraysOnTheDiskOnceThereAreMoreThanMemoryShallHold) {
  const Bytes first(3 * mebibyte);
  EXPECT_EQ(spilled_bytes(), 0U);
  {
    const Bytes second(3 * mebibyte);
    EXPECT_EQ(spilled_bytes(), second.size());
  }
  EXPECT_EQ(spilled_bytes(), 0U);
}

TEST_F(Spill, LeavesSmallArraysInMemory) {
  const std::vector<Bytes> many(20, Bytes(mebibyte / 2));
  EXPECT_EQ(spilled_bytes(), 0U);
}

TEST_F(Spill, LeavesNoNameInTheFolder) {
  const Bytes bytes(8 * mebibyte);
  EXPECT_EQ(spilled_bytes(), bytes.size());
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(Spill, KeepsValuesWhosePagesWereGivenBack) {
  std::vector<std::uint32_t> numbers(4 * mebibyte);
  for (int round = 0; round < 5; ++round) {
    std::iota(numbers.begin(), numbers.end(), static_cast<std::uint32_t>(round));
    ::madvise(numbers.data(), numbers.size() * sizeof numbers[0], MADV_DONTNEED);  // as the system does
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < numbers.size(); ++i)
      wrong += numbers[i] != i + static_cast<std::uint32_t>(round);
    EXPECT_EQ(wrong, 0U) << round;
  }
}

// Of so many of its own small blocks some begin with a page, as arrays do that it has mapped.
TEST_F(Spill, TellsItsOwnBlocksFromArraysThatAreMapped) {
  arrays_near(path(), {.array_bytes = 8192, .in_memory_bytes = 4 * mebibyte});
  {
    std::vector<Bytes> arrays;
    for (int i = 0; i < 1000; ++i) arrays.emplace_back(8192, 1);
    EXPECT_GT(spilled_bytes(), 0U);
  }
  EXPECT_EQ(spilled_bytes(), 0U);
}

TEST_F(Spill, LeavesArraysOfAForkedProcessToItself) {
  Bytes bytes(8 * mebibyte, 1);
  const pid_t child = ::fork();
  if (child == 0) {
    arrays_in_memory();
    const Bytes own(8 * mebibyte, 2);
    ::_exit(spilled_bytes() == bytes.size() && own.back() == 2 ? 0 : 1);
  }
  int status = 1;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST_F(Spill, TakesArraysOfSeveralThreads) {
  const auto work = [] {
    for (int i = 0; i < 20; ++i) EXPECT_EQ(Bytes(2 * mebibyte, 7).back(), 7);
  };
  std::thread other(work), another(work);
  work();
  other.join();
  another.join();
  EXPECT_EQ(spilled_bytes(), 0U);
}

TEST_F(Spill, LeavesArraysInMemoryWhereNoFileMayBeSoLarge) {
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{mebibyte, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const Bytes bytes(8 * mebibyte, 1);
  EXPECT_EQ(spilled_bytes(), 0U);
  EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
}

}  // namespace
}  // namespace thermorig::spill
