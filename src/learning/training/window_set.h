// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thermorig/network/batch.h"
#include "thermorig/network/scaling.h"
#include "thermorig/network/window_index.h"

namespace thermorig::training {

/// Windows of acquisitions, ready for the network. Keeps the prepared frames: (N, H, W) floats an acquisition
/// that has a window.
class WindowSet {
 public:
  /// The windows point into `acquisitions`, which must live as long as this.
  WindowSet(std::span<const network::Acquisition> acquisitions, std::vector<network::Window> windows,
            const network::Shape& shape, const network::Scaling& scaling);

  std::size_t size() const { return windows_.size(); }
  const network::Shape& shape() const { return shape_; }
  const network::Window& window(std::size_t index) const { return windows_[index]; }
  const network::Acquisition& acquisition_of(std::size_t index) const {
    return acquisitions_[windows_[index].acquisition];
  }
  const network::WindowRates& rates(std::size_t index) const { return rates_[index]; }  // deg/s
  const float* frames(std::size_t index) const;  // (Nf, H, W), normalised
  float label(std::size_t index) const { return rates_[index].label_dps / scaling_.label_scale_dps; }
  float gyro(std::size_t index) const { return rates_[index].gyro_dps / scaling_.label_scale_dps; }

 private:
  std::span<const network::Acquisition> acquisitions_;
  std::vector<network::Window> windows_;
  network::Shape shape_;
  network::Scaling scaling_;
  std::vector<std::vector<float>> prepared_;  // by acquisition
  std::vector<network::WindowRates> rates_;   // by window
};

/// Up to 32 windows of a set, put together for the network.
class BatchBuffer {
 public:
  explicit BatchBuffer(const WindowSet& set) : set_(set) {}

  void clear();
  /// `mirrored`: the images flipped left to right, label and gyro negated.
  void add(std::size_t index, bool mirrored = false);
  std::size_t size() const { return frames_.size(); }
  /// Valid until the next change.
  network::Batch batch() const;

 private:
  const WindowSet& set_;
  std::vector<const float*> frames_;
  std::vector<float> gyro_, label_;
  std::vector<std::uint8_t> mirrored_;
};

}  // namespace thermorig::training
