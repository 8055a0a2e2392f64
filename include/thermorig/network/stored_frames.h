// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <span>

namespace thermorig::network {

struct Acquisition;

/// The pixels of an acquisition that lie elsewhere than in memory. May be asked from several threads.
class StoredFrames {
 public:
  virtual ~StoredFrames() = default;

  /// As many frames as fill `temp_c`, (n, 24, 32), from frame `first` on, bit for bit as they were. Throws
  /// Error(storage) where they cannot be read.
  virtual void read(std::size_t first, std::span<float> temp_c) const = 0;

  /// So many frames from `first` on will be read soon.
  virtual void announce(std::size_t first, std::size_t frames) const = 0;
};

/// Takes frame after frame of an acquisition, in order, wherever they lie: its index and its pixels, (24,
/// 32), valid during the call. Throws as StoredFrames::read().
using FrameLook = std::function<void(std::size_t frame, std::span<const float> temp_c)>;
void for_each_frame(const Acquisition& acquisition, const FrameLook& look);

}  // namespace thermorig::network
