// SPDX-License-Identifier: MIT
#include "thermorig/io/spill/spill.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdint>
#include <fstream>
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
    arrays_near(path(), {.array_bytes = mebibyte, .in_memory_bytes = 4 * mebibyte, .resident_bytes = 1});
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

// Pages are given back all the time: more than one byte of them is too many.
TEST_F(Spill, KeepsValuesWhosePagesWereGivenBack) {
  std::vector<std::uint32_t> numbers(4 * mebibyte);
  for (int round = 0; round < 5; ++round) {
    std::iota(numbers.begin(), numbers.end(), static_cast<std::uint32_t>(round));
    std::this_thread::yield();
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

/// Whether the page at `at` is mapped: the highest of the 64 bits that the system tells of it.
bool is_mapped(const std::uint8_t* at) {
  constexpr std::uint64_t page_bytes = 4096;
  std::ifstream pages("/proc/self/pagemap", std::ios::binary);
  pages.seekg(static_cast<std::streamoff>(reinterpret_cast<std::uintptr_t>(at) / page_bytes * 8));
  std::uint64_t page = 0;
  pages.read(reinterpret_cast<char*>(&page), sizeof page);
  return (page >> 63U) != 0;
}

TEST_F(Spill, GivesPagesBackWhateverItsThreadDoesEvenIfThatWasToldToTakeNoSignals) {
  std::thread([] {
    sigset_t all;
    sigfillset(&all);
    ASSERT_EQ(::pthread_sigmask(SIG_SETMASK, &all, nullptr), 0);
    Bytes bytes(8 * mebibyte);
    bytes[0] = 5;
    while (is_mapped(bytes.data())) {  // nothing here asks for it
    }
    EXPECT_EQ(bytes[0], 5);
  }).join();
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

TEST(EveryBytes, AreDueAgainAndAgain) {
  EveryBytes four(4);
  for (int round = 0; round < 3; ++round) {
    EXPECT_FALSE(four.is_due_after(3));
    EXPECT_TRUE(four.is_due_after(1));
  }
  EXPECT_TRUE(four.is_due_after(9));  // what is too much is not owed
  EXPECT_FALSE(four.is_due_after(3));
}

}  // namespace
}  // namespace thermorig::spill
