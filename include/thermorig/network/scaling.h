// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "thermorig/network/acquisition.h"
#include "thermorig/network/shape.h"

namespace thermorig::network {

/// How degrees and deg/s become the network's numbers. Kept in the model file.
struct Scaling {
  float label_scale_dps = 200.0F;  // speeds are divided by it
  float temp_mean_c = 0.0F;        // of all pixels of the training data's valid frames
  float temp_deviation_c = 1.0F;   // above 0
  bool by_window = false;          // frames stay degrees (mean 0, deviation 1) until scale_window()
  float frame_period_s = 0.0F;     // of the camera that label_scale_dps is meant for; 0: any
  bool gate_states_sigma = false;  // Kg means gate_sigma() of the speed from the images (network/trainer.h)
  bool operator==(const Scaling&) const = default;

  /// Deg/s that the network calls 1, where frames come every `period_s` > 0. With a frame_period_s it speaks
  /// in degrees a period: a slower camera sees the same images at a lower speed.
  float speed_scale_dps(double period_s) const {
    return frame_period_s > 0.0F ? static_cast<float>(double{label_scale_dps} * frame_period_s / period_s)
                                 : label_scale_dps;
  }
};

/// Of a network that scales each window by itself.
Scaling scaling_by_window(float label_scale_dps = 200.0F);

/// Mean and deviation of the pixels of all frames that are in a valid run, over all acquisitions but the one
/// of index `without`.
Scaling scaling_of(std::span<const Acquisition> acquisitions, float label_scale_dps = 200.0F,
                   std::optional<std::size_t> without = {});

/// One frame to what the network takes: averages of Nr x Nr neighbours (columns that do not fill a block are
/// cropped), then (temp - mean) / deviation. `temp_c`: (24, 32); `out`: (H, W).
void prepare_frame(std::span<const float> temp_c, const network::Shape& shape, const Scaling& scaling,
                   std::span<float> out);

/// A window of degrees to what a network takes that scales by the window, in place: each row less its mean
/// over the frames, all over one deviation, clamped at +-4. Both are found without the pixels that are more
/// than 3 deviations from their row, in four rounds; the deviation is 0.01 K at least. `degrees`: (Nf, H, W).
void scale_window(std::span<float> degrees, const network::Shape& shape);

/// All frames of an acquisition, prepared: (N, H, W). A window is Nf consecutive frames, so it is a part of
/// this array as it is.
std::vector<float> prepare(const Acquisition& acquisition, const network::Shape& shape,
                           const Scaling& scaling);

}  // namespace thermorig::network
