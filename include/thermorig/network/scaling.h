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
  bool operator==(const Scaling&) const = default;
};

/// Mean and deviation of the pixels of all frames that are in a valid run, over all acquisitions but the one
/// of index `without`.
Scaling scaling_of(std::span<const Acquisition> acquisitions, float label_scale_dps = 200.0F,
                   std::optional<std::size_t> without = {});

/// One frame to what the network takes: averages of Nr x Nr neighbours (columns that do not fill a block are
/// cropped), then (temp - mean) / deviation. `temp_c`: (24, 32); `out`: (H, W).
void prepare_frame(std::span<const float> temp_c, const network::Shape& shape, const Scaling& scaling,
                   std::span<float> out);

/// All frames of an acquisition, prepared: (N, H, W). A window is Nf consecutive frames, so it is a part of
/// this array as it is.
std::vector<float> prepare(const Acquisition& acquisition, const network::Shape& shape,
                           const Scaling& scaling);

}  // namespace thermorig::network
