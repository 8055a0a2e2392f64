// SPDX-License-Identifier: MIT
#include "for_each_file.h"

#include <mutex>

#include "thermorig/core/run_all.h"

namespace thermorig::dataset {

void for_each_file(std::size_t count, const std::function<void(std::size_t)>& work,
                   const ReadingProgress& progress) {
  std::mutex turn;
  std::size_t done = 0;
  on_all_cores(count, [&](std::size_t file) {
    work(file);
    const std::lock_guard lock(turn);
    ++done;
    if (progress) progress(done, count);
  });
}

}  // namespace thermorig::dataset
