// SPDX-License-Identifier: MIT
#include "session_data.h"

#include <fmt/format.h>

#include <algorithm>

#include "output.h"
#include "thermorig/dataset/dataset.h"

namespace thermorig::app {

std::vector<windows::Acquisition> read_data(const std::vector<std::filesystem::path>& paths, bool json) {
  const bool told = !json && escapes_allowed(stdout);
  const auto tell = [](std::size_t done, std::size_t all) {
    print("\rreading sessions: {} of {}", done, all);
    std::fflush(stdout);
  };
  const std::vector<std::filesystem::path> files = dataset::find_sessions(paths);
  std::vector<windows::Acquisition> acquisitions =
      told ? dataset::read_acquisitions(files, tell) : dataset::read_acquisitions(files);
  if (told) print("\r\x1b[K");
  return acquisitions;
}

bool any_simulated(const std::vector<windows::Acquisition>& acquisitions) {
  return std::any_of(acquisitions.begin(), acquisitions.end(),
                     [](const windows::Acquisition& acquisition) { return acquisition.simulated; });
}

}  // namespace thermorig::app
