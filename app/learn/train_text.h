// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "train_output.h"

namespace thermorig::app {

// What `train` says to people. No escape codes.

/// What there is to train on.
struct WindowCounts {
  struct Row {
    std::uint64_t acquisitions = 0, simulated = 0, frames = 0, windows = 0;
  };
  std::map<std::string, Row> environments;
  Row all;
  std::vector<std::string> without;  // acquisitions that have no window
};
WindowCounts count_windows(const TrainStart& start);

/// Acquisitions and windows by environment, whether they are simulated, and the settings.
std::string start_text(const TrainStart& start);

/// One finished epoch: a line, and another for the held-out error. `left`: how long all others will take; ""
/// for nothing.
std::string epoch_text(const training::EpochReport& report, const training::TrainingConfig& config,
                       const std::string& left = "");

/// "epoch 12 of 40, 57 %, loss 0.0123, 2 min 3 s left".
std::string standing_text(const TrainStanding& standing, const training::TrainingConfig& config);

/// Errors of the network and of the gyro alone, the gate, what was written, what to do next.
std::string end_text(const TrainEnd& end);

/// What a user ought to know about the result: a collapsed gate, a gyro that is better alone.
std::vector<std::string> warnings_of(const TrainEnd& end);

/// Seconds to the end; NaN before the first step.
double seconds_left(const TrainStanding& standing, const training::TrainingConfig& config);

}  // namespace thermorig::app
