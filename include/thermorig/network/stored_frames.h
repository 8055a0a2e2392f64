// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace thermorig::network {

struct Acquisition;

/// Pixels in half of the room, without the loss of a bit: whole hundredths of a degree, which is what cameras
/// send, in 16 bits; floats where any of them is none. May be asked from several threads.
class PackedFrames {
 public:
  /// (n, 24, 32), degrees Celsius.
  explicit PackedFrames(std::vector<float> temp_c);

  /// As many frames as fill `temp_c`, (n, 24, 32), from frame `first` on, bit for bit as they were.
  void read(std::size_t first, std::span<float> temp_c) const;

  std::size_t bytes() const {
    return hundredths_.size() * sizeof(std::int16_t) + temp_c_.size() * sizeof(float);
  }

 private:
  std::vector<std::int16_t> hundredths_;
  std::vector<float> temp_c_;  // where hundredths would lose a bit
};

/// Takes frame after frame of an acquisition, in order, packed or not: its index and its pixels, (24, 32),
/// valid during the call.
using FrameLook = std::function<void(std::size_t frame, std::span<const float> temp_c)>;
void for_each_frame(const Acquisition& acquisition, const FrameLook& look);

}  // namespace thermorig::network
