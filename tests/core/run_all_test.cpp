// SPDX-License-Identifier: MIT
#include "thermorig/core/run_all.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <vector>

namespace thermorig {
namespace {

constexpr std::size_t many = 1000;

TEST(AllCores, DoEachNumberOnce) {
  std::vector<std::atomic<int>> done(many);
  on_all_cores(many, [&](std::size_t i) { ++done[i]; });
  for (const auto& times : done) EXPECT_EQ(times, 1);
}

TEST(AllCores, HaveNothingToDoForNone) {
  on_all_cores(0, [](std::size_t) { FAIL(); });
}

TEST(AllCores, ThrowWhatTheLowestNumberThrewThatFailed) {
  for (int round = 0; round < 20; ++round) {
    try {
      on_all_cores(many, [](std::size_t i) {
        if (i % 100 == 37) throw std::runtime_error(std::to_string(i));
      });
      ADD_FAILURE();
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "37");
    }
  }
}

TEST(AllCores, BeginNothingAfterAFailureWasSeen) {
  std::atomic<std::size_t> begun = 0;
  EXPECT_THROW(on_all_cores(1'000'000,
                            [&](std::size_t) {
                              ++begun;
                              throw std::runtime_error("at once");
                            }),
               std::runtime_error);
  EXPECT_LT(begun, 1000U);
}

}  // namespace
}  // namespace thermorig
