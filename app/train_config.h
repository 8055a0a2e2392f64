// SPDX-License-Identifier: MIT
#pragma once

#include "options.h"
#include "thermorig/training/training.h"

namespace thermorig::app {

/// The preset with what the command line changes. Throws Error(bad_usage) for what cannot be.
training::TrainingConfig training_config(const TrainOptions& options);

}  // namespace thermorig::app
