// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "frame_memory.h"
#include "thermorig/core/error.h"
#include "thermorig/learning/dataset/dataset.h"
#include "thermorig/learning/training/fit.h"
#include "thermorig/learning/training/training.h"

namespace thermorig::app {

/// What is about to be trained, and on what.
struct TrainStart {
  const training::TrainingConfig& config;
  Label label = Label::commanded;  // that is learnt
  const dataset::Acquisitions& data;
  const FrameMemory& memory;
  std::string run_folder;
  std::string instruction_set;
  int threads = 1;
  int epochs_done = 0;  // by an earlier part of the run
};

/// Where a training stands.
struct TrainStanding {
  int epochs_before = 0;  // done by an earlier part of the run
  int epoch = 0;          // in which it is, from 1
  std::size_t step = 0, steps = 0;
  double loss = 0.0;       // mean over the epoch so far
  double elapsed_s = 0.0;  // since this part of the run began
};

/// How it ended.
struct TrainEnd {
  const training::TrainingConfig& config;
  const training::TrainingResult& result;
  const training::Fits* fits = nullptr;  // none: not one epoch was done
  std::string model;                     // file that was written; empty: none
  double seconds = 0.0;                  // over all parts of the run
  bool labelled_by_gyro = false;         // one of the sessions at least: its rig had no servo
  ExitCode exit = ExitCode::ok;
};

/// Shows a training: on a terminal a line a finished epoch and one that is drawn over, elsewhere a line a
/// finished epoch, with `json` an object an event.
class TrainOutput {
 public:
  virtual ~TrainOutput() = default;
  virtual void start(const TrainStart& start) = 0;
  virtual void step(const TrainStanding& standing) = 0;
  virtual void epoch(const training::EpochReport& report, const TrainStanding& standing) = 0;
  virtual void end(const TrainEnd& end) = 0;
};

std::unique_ptr<TrainOutput> make_train_output(const training::TrainingConfig& config, bool json);

}  // namespace thermorig::app
