// SPDX-License-Identifier: MIT
#include "held_out.h"

#include <fmt/format.h>

#include <set>

#include "draw.h"
#include "thermorig/core/error.h"

namespace thermorig::training {

namespace {

using network::Window;

[[noreturn]] void refuse_no_window(const TrainingConfig& config) {
  throw Error(ExitCode::bad_usage,
              fmt::format("there is no window of {} valid frames in a row to train on",
                          std::max(config.shape.frames, config.history)),
              "", "fewer frames (--nf), or sessions whose `thermorig inspect` shows valid frames");
}

std::uint32_t drawn_acquisition(const TrainingConfig& config, const std::vector<Window>& windows) {
  std::set<std::uint32_t> with_windows;
  for (const Window& window : windows) with_windows.insert(window.acquisition);
  if (with_windows.size() < 2)
    throw Error(ExitCode::bad_usage, "one acquisition is to choose the epoch, and there is but one in all",
                "", "more sessions, or --no-choose-epoch, which keeps the last epoch");
  const std::uint64_t place = Draw(config.seed, "held-out").below(with_windows.size());
  return *std::next(with_windows.begin(), static_cast<std::ptrdiff_t>(place));
}

}  // namespace

Division divide(const TrainingConfig& config, std::span<const network::Acquisition> acquisitions) {
  const std::vector<Window> all = network::find_windows(acquisitions, config.shape.frames, config.history);
  Division division;
  if (all.empty() && config.made.windows == config.batch && acquisitions.empty()) return division;
  if (all.empty()) refuse_no_window(config);
  if (config.choose_epoch) division.held_out_acquisition = drawn_acquisition(config, all);
  for (const Window& window : all)
    (window.acquisition == division.held_out_acquisition ? division.held_out : division.training)
        .push_back(window);
  return division;
}

}  // namespace thermorig::training
