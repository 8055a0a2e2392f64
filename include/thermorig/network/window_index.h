// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thermorig/network/acquisition.h"

namespace thermorig::network {

/// The one rule of which frames make a labelled window, frame by frame: the last `frames` frames are
/// consecutive frames of one valid run. `history` >= `frames` asks for that many in a row, so that windows of
/// different lengths end at the same frames.
class WindowRule {
 public:
  explicit WindowRule(int frames, int history = 0);

  /// The next frame of the acquisition lies in this run (0: it is not valid). May a window end here?
  bool push(std::uint32_t run);

 private:
  int needed_;
  std::uint32_t run_ = 0;
  int count_ = 0;
};

/// A window: `frames` frames up to and with `last` of acquisition `acquisition`. Stride 1.
struct Window {
  std::uint32_t acquisition = 0;  // index into the span that find_windows was given
  std::uint32_t last = 0;         // index of its newest frame
  bool operator==(const Window&) const = default;
};

/// All windows of the acquisitions, in order.
std::vector<Window> find_windows(std::span<const Acquisition> acquisitions, int frames, int history = 0);

/// Mean of the rates of a window's frames: unknown if one of them is.
float mean_rate(std::span<const float> rates_dps);

/// The same of a window of an acquisition, of whose frames these are the rates.
float mean_rate(std::span<const float> rates_dps, const Window& window, int frames);

/// Label and gyro of a window: the means of its frames'.
struct WindowRates {
  float label_dps = 0.0F;
  float gyro_dps = 0.0F;
};
WindowRates rates_of(const Acquisition& acquisition, const Window& window, int frames);

}  // namespace thermorig::network
