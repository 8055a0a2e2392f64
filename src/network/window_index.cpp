// SPDX-License-Identifier: MIT
#include "thermorig/network/window_index.h"

#include <algorithm>
#include <cassert>

namespace thermorig::network {

namespace {

void append_windows(const Acquisition& acquisition, std::uint32_t index, WindowRule rule,
                    std::vector<Window>& windows) {
  for (std::size_t frame = 0; frame < acquisition.frames(); ++frame)
    if (rule.push(acquisition.run[frame])) windows.push_back({index, static_cast<std::uint32_t>(frame)});
}

}  // namespace

WindowRule::WindowRule(int frames, int history) : needed_(std::max(frames, history)) {
  assert(frames > 0);
}

bool WindowRule::push(std::uint32_t run) {
  count_ = run == 0 ? 0 : run == run_ ? std::min(count_ + 1, needed_) : 1;
  run_ = run;
  return count_ >= needed_;
}

std::vector<Window> find_windows(std::span<const Acquisition> acquisitions, int frames, int history) {
  std::vector<Window> windows;
  const WindowRule rule(frames, history);
  for (std::size_t index = 0; index < acquisitions.size(); ++index)
    append_windows(acquisitions[index], static_cast<std::uint32_t>(index), rule, windows);
  return windows;
}

float mean_rate(std::span<const float> rates_dps) {
  double sum = 0.0;
  for (const float rate_dps : rates_dps) sum += rate_dps;
  return static_cast<float>(sum / static_cast<double>(rates_dps.size()));
}

float mean_rate(std::span<const float> rates_dps, const Window& window, int frames) {
  assert(window.last < rates_dps.size() && static_cast<int>(window.last) + 1 >= frames);
  const auto count = static_cast<std::size_t>(frames);
  return mean_rate(rates_dps.subspan(std::size_t{window.last} + 1 - count, count));
}

WindowRates rates_of(const Acquisition& acquisition, const Window& window, int frames) {
  return {mean_rate(acquisition.label_dps, window, frames), mean_rate(acquisition.gyro_dps, window, frames)};
}

}  // namespace thermorig::network
