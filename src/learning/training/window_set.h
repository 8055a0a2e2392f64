// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thermorig/network/batch.h"
#include "thermorig/network/scaling.h"
#include "thermorig/network/window_index.h"

namespace thermorig::training {

/// Windows of acquisitions, ready for the network. Keeps the prepared frames, (N, H, W) floats, of an
/// acquisition that has a window and whose pixels are in memory; those of others are read and prepared window
/// by window.
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
  /// Whether there are windows whose frames have to be read.
  bool is_partly_stored() const { return is_partly_stored_; }
  /// (Nf, H, W), normalised; null: they have to be read.
  const float* frames(std::size_t index) const;
  /// Reads them to `place`, of so many values. Throws as network::StoredFrames::read().
  void read(std::size_t index, std::span<float> place) const;
  /// They will be read soon, if they have to be.
  void announce(std::size_t index) const;
  float label(std::size_t index) const { return rates_[index].label_dps / scaling_.label_scale_dps; }
  float gyro(std::size_t index) const { return rates_[index].gyro_dps / scaling_.label_scale_dps; }

 private:
  std::size_t first_frame(std::size_t index) const;

  std::span<const network::Acquisition> acquisitions_;
  std::vector<network::Window> windows_;
  network::Shape shape_;
  network::Scaling scaling_;
  std::vector<std::vector<float>> prepared_;  // by acquisition; empty: stored, or without a window
  bool is_partly_stored_ = false;
  std::vector<network::WindowRates> rates_;  // by window
};

/// Up to 32 windows of a set, put together for the network.
class BatchBuffer {
 public:
  explicit BatchBuffer(const WindowSet& set);

  void clear();
  /// `mirrored`: the images flipped left to right, label and gyro negated.
  void add(std::size_t index, bool mirrored = false);
  /// Reads the frames of the one at this place, if they have to be: before batch() is used. May be called
  /// from several threads, for a place each. Throws as WindowSet::read().
  void read(std::size_t place);
  std::size_t size() const { return frames_.size(); }
  /// Valid until the next change.
  network::Batch batch() const;

 private:
  std::span<float> place_of(std::size_t place);

  const WindowSet& set_;
  std::vector<float> read_;  // (32, Nf, H, W), by place in the batch; empty where nothing has to be read
  std::vector<std::size_t> indices_;
  std::vector<const float*> frames_;
  std::vector<float> gyro_, label_;
  std::vector<std::uint8_t> mirrored_;
};

}  // namespace thermorig::training
