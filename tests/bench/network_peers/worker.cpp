// SPDX-License-Identifier: MIT
#include "worker.h"

#include <time.h>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <vector>

#include "allocation_count.h"

namespace thermorig::bench {

namespace {

double microseconds(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

void answer(const std::function<void()>& call, std::size_t groups, std::size_t calls) {
  std::vector<double> processor(groups), wall(groups);
  const std::uint64_t allocations_before = allocations();
  for (std::size_t group = 0; group < groups; ++group) {
    const double begin = microseconds(CLOCK_PROCESS_CPUTIME_ID), wall_begin = microseconds(CLOCK_MONOTONIC);
    for (std::size_t i = 0; i < calls; ++i) call();
    processor[group] = (microseconds(CLOCK_PROCESS_CPUTIME_ID) - begin) / static_cast<double>(calls);
    wall[group] = (microseconds(CLOCK_MONOTONIC) - wall_begin) / static_cast<double>(calls);
  }
  const auto made = static_cast<double>(allocations() - allocations_before);
  std::printf(R"({"processor_us": %.4f, "wall_us": %.4f, "allocations": %.3f})"
              "\n",
              median(processor), median(wall), made / static_cast<double>(groups * calls));
  std::fflush(stdout);
}

}  // namespace

void serve(const Tasks& tasks) {
  std::string task;
  std::size_t groups = 0, calls = 0;
  while (std::cin >> task >> groups >> calls && groups > 0 && calls > 0)
    answer(tasks.at(task), groups, calls);
}

}  // namespace thermorig::bench
