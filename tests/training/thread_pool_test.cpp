// SPDX-License-Identifier: MIT
#include "thermorig/learning/training/thread_pool.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <thread>

namespace thermorig::training {
namespace {

TEST(ThreadPool, DoesEachPartOnceARun) {
  for (const int size : {1, 2, 3, 5}) {
    ThreadPool workers(size);
    ASSERT_EQ(workers.size(), size);
    std::array<std::atomic<int>, 5> calls{};
    for (int run = 0; run < 500; ++run)
      workers.run([&](int part) { ++calls.at(static_cast<std::size_t>(part)); });
    for (int part = 0; part < 5; ++part)
      EXPECT_EQ(calls.at(static_cast<std::size_t>(part)), part < size ? 500 : 0);
  }
}

TEST(ThreadPool, SeesWhatTheRunBeforeWrote) {
  ThreadPool workers(3);
  std::array<int, 3> written{};  // not atomic: the end of a run must order it
  for (int run = 0; run < 500; ++run) {
    workers.run([&](int part) { written.at(static_cast<std::size_t>(part)) += run; });
    workers.run([&](int part) {
      const auto neighbour = static_cast<std::size_t>((part + 1) % 3);
      EXPECT_EQ(written.at(neighbour), run * (run + 1) / 2);
    });
  }
}

TEST(ThreadPool, WakesUpAfterALongPause) {
  ThreadPool workers(2);
  std::atomic<int> calls{0};
  for (int run = 0; run < 3; ++run) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // the others sleep by now
    workers.run([&](int) { ++calls; });
  }
  EXPECT_EQ(calls, 6);
}

TEST(ThreadPool, WaitsForWhoeverIsLate) {
  ThreadPool workers(2);
  std::atomic<bool> done{false};
  workers.run([&](int part) {
    if (part == 0) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    done = true;
  });
  EXPECT_TRUE(done);
}

TEST(ThreadPool, EndsWithoutEverHavingWorked) {
  for (int size = 1; size <= 4; ++size) ThreadPool workers(size);
}

}  // namespace
}  // namespace thermorig::training
