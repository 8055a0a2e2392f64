// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "thermorig/network/batch.h"
#include "thermorig/network/scaling.h"
#include "thermorig/network/turn.h"
#include "thermorig/network/window_index.h"

namespace thermorig::training {

/// Windows of acquisitions, ready for the network. Keeps the prepared frames, (N, H, W) floats, of an
/// acquisition that has a window and whose pixels are not packed; those of others are unpacked and prepared
/// window by window.
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
  /// Whether all windows lie in memory as the network takes them.
  bool is_ready() const { return !is_partly_packed_ && !scaling_.by_window; }
  /// (Nf, H, W), normalised; null: prepare() makes it.
  const float* frames(std::size_t index) const { return is_ready() ? in_memory(index) : nullptr; }
  /// The window as the network takes it, turned, to `place`, of so many values.
  void prepare(std::size_t index, network::Turn turn, std::span<float> place) const;
  /// Deg/s that the network calls 1 there.
  float speed_scale_dps(std::size_t index) const {
    return scaling_.speed_scale_dps(acquisition_of(index).frame_period_s);
  }
  float label(std::size_t index) const { return rates_[index].label_dps / speed_scale_dps(index); }
  float gyro(std::size_t index) const { return rates_[index].gyro_dps / speed_scale_dps(index); }

 private:
  std::size_t first_frame(std::size_t index) const;
  const float* in_memory(std::size_t index) const;
  void read(std::size_t index, std::span<float> place) const;

  std::span<const network::Acquisition> acquisitions_;
  std::vector<network::Window> windows_;
  network::Shape shape_;
  network::Scaling scaling_;
  std::vector<std::vector<float>> prepared_;  // by acquisition; empty: packed, or without a window
  bool is_partly_packed_ = false;
  std::vector<network::WindowRates> rates_;  // by window
};

/// A window that was made up, as the network takes it.
struct MadeWindow {
  const float* frames = nullptr;  // (Nf, H, W)
  float label = 0.0F, gyro = 0.0F;
};

/// Up to 32 windows of a set, and such that were made up, put together for the network.
class BatchBuffer {
 public:
  explicit BatchBuffer(const WindowSet& set);

  void clear();
  /// Turned; label and gyro have the sign of the turn.
  void add(std::size_t index, network::Turn turn = network::Turn());
  void add(const MadeWindow& window, network::Turn turn);
  /// Prepares the one at this place, if it has to be: before batch() is used. May be called from several
  /// threads, for a place each.
  void prepare(std::size_t place);
  std::size_t size() const { return frames_.size(); }
  /// Whether there is one.
  bool has_unprepared() const { return has_unprepared_; }
  /// Valid until the next change.
  network::Batch batch() const;

 private:
  /// Where its frames come from: a window of the set, or one that was made up.
  struct Source {
    std::size_t index = 0;
    const float* made = nullptr;
    network::Turn turn;
  };

  std::span<float> place_of(std::size_t place);
  void add(const Source& source, const float* ready, float label, float gyro);

  const WindowSet& set_;
  std::vector<float> prepared_;  // (32, Nf, H, W), by place in the batch
  std::vector<Source> sources_;
  bool has_unprepared_ = false;
  std::vector<const float*> frames_;
  std::vector<float> gyro_, label_;
  std::vector<std::uint8_t> mirrored_;
};

}  // namespace thermorig::training
