// SPDX-License-Identifier: MIT
#include "thermorig/windows/window_index.h"

#include <algorithm>
#include <cassert>

namespace thermorig::windows {

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

WindowRates rates_of(const Acquisition& acquisition, const Window& window, int frames) {
  assert(window.last < acquisition.frames() && static_cast<int>(window.last) + 1 >= frames);
  const auto count = static_cast<std::size_t>(frames);
  const std::size_t first = std::size_t{window.last} + 1 - count;
  const auto mean = [&](const std::vector<float>& rates_dps) {
    return mean_rate(std::span(rates_dps).subspan(first, count));
  };
  return {mean(acquisition.label_dps), mean(acquisition.gyro_dps)};
}

}  // namespace thermorig::windows
