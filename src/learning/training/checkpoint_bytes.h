// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "thermorig/learning/training/training.h"

namespace thermorig::training {

/// A checkpoint as bytes: "THRCKPT1", counts, weights, moments, epochs, CRC-32 of all before it;
/// little-endian. It holds no shape: that stands in the run's description.
std::string checkpoint_bytes(const Checkpoint& checkpoint);

/// How long they are at most for this training.
std::size_t checkpoint_bytes_max(const TrainingConfig& config);

/// Nothing if they are damaged, or not a checkpoint of such a training.
std::optional<Checkpoint> checkpoint_from(std::string_view bytes, const TrainingConfig& config);

}  // namespace thermorig::training
