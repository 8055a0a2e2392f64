// SPDX-License-Identifier: MIT
#include "thermorig/learning/training/thread_pool.h"

#include <atomic>
#include <cassert>
#include <thread>
#include <vector>

namespace thermorig::training {

namespace {

// Parts of a step follow each other within microseconds; whoever sleeps loses some 50 of them. Longer waits
// are those at the end of an epoch or for a core that somebody else has.
constexpr int busy_looks = 2000;

void relax() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

/// Returns once `value` is no more what it was.
std::uint32_t wait_while(const std::atomic<std::uint32_t>& value, std::uint32_t was) {
  for (int look = 0; look < busy_looks; ++look) {
    if (const std::uint32_t now = value.load(std::memory_order_acquire); now != was) return now;
    relax();
  }
  value.wait(was, std::memory_order_acquire);
  return value.load(std::memory_order_acquire);
}

}  // namespace

struct ThreadPool::Parts {
  std::atomic<std::uint32_t> round{0};             // counts the calls of run(); the last one ends the threads
  std::atomic<std::uint32_t> busy{0};              // others that have not finished this round
  const std::function<void(int)>* work = nullptr;  // of this round; null: end
  std::vector<std::thread> others;

  void serve(int number) {
    for (std::uint32_t seen = 0;;) {
      seen = wait_while(round, seen);
      if (work == nullptr) return;
      (*work)(number);
      if (busy.fetch_sub(1, std::memory_order_acq_rel) == 1) busy.notify_one();
    }
  }

  void begin(const std::function<void(int)>* next) {
    work = next;
    busy.store(static_cast<std::uint32_t>(others.size()), std::memory_order_relaxed);
    round.fetch_add(1, std::memory_order_release);
    round.notify_all();
  }

  void await_end() {
    for (std::uint32_t left = busy.load(std::memory_order_acquire); left != 0;) left = wait_while(busy, left);
  }
};

ThreadPool::ThreadPool(int size) : parts_(std::make_unique<Parts>()) {
  assert(size >= 1);
  for (int number = 1; number < size; ++number)
    parts_->others.emplace_back([parts = parts_.get(), number] { parts->serve(number); });
}

ThreadPool::~ThreadPool() {
  parts_->begin(nullptr);
  for (std::thread& other : parts_->others) other.join();
}

int ThreadPool::size() const {
  return static_cast<int>(parts_->others.size()) + 1;
}

void ThreadPool::run(const std::function<void(int)>& work) {
  if (parts_->others.empty()) return work(0);
  parts_->begin(&work);
  work(0);
  parts_->await_end();
}

}  // namespace thermorig::training
