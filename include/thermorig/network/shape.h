// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

namespace thermorig::network {

// Dimensions, here and in all comments: B samples of a batch, Nf frames of a window, H x W pixels after
// averaging Nr x Nr.

inline constexpr int min_frames = 2, max_frames = 6;
inline constexpr int min_reduction = 1, max_reduction = 3;
inline constexpr int kernel_size = 5;  // both convolutions, paper section III
inline constexpr int filters1 = 6;     // Conv1
inline constexpr int filters2 = 16;    // Conv2
inline constexpr int hidden1 = 120;    // first layer of the speed head, and of the gain head
inline constexpr int hidden2 = 80;     // second layer of the speed head
inline constexpr int max_batch = 32;

/// What the paper's network looks like (paper section III, Fig. 2), with what it leaves open as fields.
/// Conv1 6@5x5, ReLU; max-pool 2 (an odd last row or column is dropped); Conv2 16@5x5, ReLU; flatten
/// (channel, row, column); speed head 120, 80 (ReLU), 1; gain head 120 (ReLU), 1 (sigmoid).
struct Shape {
  int frames = 3;      // Nf
  int reduction = 1;   // Nr
  bool fusion = true;  // false: thermal-only, no gain head
  int padding1 = 2;    // zeros around the input of Conv1, 0..2
  int padding2 = 2;    // the same for Conv2
  int crop_left = 0;  // of the columns that do not fill a block (Nr = 3: 2), how many are dropped at the left

  int rows() const { return 24 / reduction; }     // H
  int columns() const { return 32 / reduction; }  // W: 32, 16, 10
  std::size_t pixels() const {
    return static_cast<std::size_t>(rows()) * static_cast<std::size_t>(columns());
  }
  std::size_t inputs() const { return static_cast<std::size_t>(frames) * pixels(); }  // Nf * H * W
  int rows1() const { return rows() + 2 * padding1 - (kernel_size - 1); }             // after Conv1
  int columns1() const { return columns() + 2 * padding1 - (kernel_size - 1); }
  int pooled_rows() const { return rows1() / 2; }
  int pooled_columns() const { return columns1() / 2; }
  int rows2() const { return pooled_rows() + 2 * padding2 - (kernel_size - 1); }  // after Conv2
  int columns2() const { return pooled_columns() + 2 * padding2 - (kernel_size - 1); }
  int features() const {
    return filters2 * rows2() * columns2();
  }  // after flatten: 3072, 768, 320 by default

  bool operator==(const Shape&) const = default;
};

/// Why a network of this shape cannot exist, as a sentence; nothing if it can.
std::optional<std::string> fault_of(const Shape& shape);

/// Number of weights, biases included. Nf = 3 by default: 750,274 / 197,314 / 89,794 (thermal-only 381,393 /
/// 104,913 / 51,153).
std::size_t weight_count(const Shape& shape);

/// Multiply-adds of one window's forward pass. Nf = 3, Nr = 1, fusion: 1,553,480.
std::uint64_t multiply_adds(const Shape& shape);

}  // namespace thermorig::network
