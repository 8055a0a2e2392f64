// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thermorig/network/acquisition.h"
#include "thermorig/network/model/model.h"
#include "thermorig/network/trainer.h"

namespace thermorig::training {

/// Windows of rooms that are made up while a training runs: no recording is needed, and none is shared.
struct MadeRooms {
  int windows = 0;            // of each batch; 0: none, all of them: no recording
  network::CameraView view;   // that sees them
  int steps_an_epoch = 1000;  // where there is no recording that an epoch could go through
  int rounds_kept = 48;  // of 8 rooms and 192 windows each, a new one every 32 steps: how many are in use
};

/// A network that a training begins with instead of drawn weights.
struct Beginning {
  std::string name;  // of it, and of its weights' sum: for the run's description
  network::Weights weights;
};

/// How a network is trained. Paper section III; what it leaves open is a setting.
struct TrainingConfig {
  std::string preset = "best";  // "paper", "best", or "custom" once anything differs from both
  network::Shape shape;
  int epochs = 40;
  int batch = 32;  // 1..32
  network::LossConfig loss;
  network::AdamConfig adam;
  // Of how many symmetries each window is shown in one, drawn anew each epoch: 1 as it is, 2 half of them
  // flipped left to right with speed and gyro negated, 8 all of network::Turn.
  int symmetries = 1;
  bool window_scaling =
      false;            // each window by itself, speeds in degrees a frame period; else by the data set
  bool cosine = false;  // the rate rises over the first steps, then falls as half a cosine; else constant
  MadeRooms made;
  std::shared_ptr<const Beginning> from;  // null: drawn by the seed
  // Keep the epoch with the lowest error on one held-out training acquisition (fused plus, weighed as in the
  // loss, thermal); false: the last.
  bool choose_epoch = false;
  int history = 0;  // valid frames in a row that a window's end needs, see network::WindowRule
  std::uint64_t seed =
      1;  // of the first weights, of the order of windows, of the mirror and of the held-out acquisition
  float label_scale_dps = 200.0F;
};

/// Preset `paper`: to the letter (berHu alone, scaled by the data set, no symmetry). Preset `best`:
/// likelihood, scaled by the window, eight symmetries, a cosine of rates (docs/training.md). Both keep the
/// last epoch. Throws Error(bad_usage) for another name.
TrainingConfig preset(const std::string& name);

/// "paper" or "best" if everything that a preset fixes is as it has it, else "custom". Shape, seed,
/// `history`, `made` and `from` are not what a preset fixes.
std::string preset_of(const TrainingConfig& config);

/// Throws Error(bad_usage) with what cannot be: a shape that does not exist, a number out of its range.
void check(const TrainingConfig& config);

/// Throws Error(bad_usage) where there is nothing to train on: no window, fewer than two acquisitions with
/// choose_epoch.
void check_data(const TrainingConfig& config, std::span<const network::Acquisition> acquisitions);

/// What an epoch showed. Errors normalised (divided by label_scale_dps).
struct EpochReport {
  int epoch = 0;                      // from 1
  double loss = 0.0;                  // mean over the epoch's windows
  double training_mse = 0.0;          // the same of the squared errors, each before its step
  double held_out_mse = 0.0;          // NaN without a held-out acquisition
  double held_out_thermal_mse = 0.0;  // of y_th there; NaN likewise
  double gain_mean = 1.0;             // of Kg over the epoch
  double seconds = 0.0;               // elapsed since training began; train() looks at no clock and leaves 0
  bool kept = false;                  // the best so far, or the last
};

/// The root of such an error, as a speed.
inline double rmse_dps(double mse, const TrainingConfig& config) {
  return std::sqrt(mse) * static_cast<double>(config.label_scale_dps);
}

/// What chooses the epoch, the lowest: the error on the held-out acquisition, weighed as the loss weighs its
/// parts (held_out_mse + auxiliary_thermal * held_out_thermal_mse). The fused error alone would tell how good
/// that one acquisition's gyro happens to be.
double held_out_score(const EpochReport& report, const TrainingConfig& config);

/// Everything that going on needs, between two epochs.
struct Checkpoint {
  int epoch = 0;  // done
  network::Weights weights;
  network::OptimiserState optimiser;
  network::Weights kept;  // best so far
  int epoch_kept = 0;
  std::vector<EpochReport> epochs;
};

struct TrainingResult {
  model::Model model;
  std::vector<EpochReport> epochs;
  bool stopped = false;     // before the last epoch
  std::size_t windows = 0;  // trained on, those that choose the epoch not among them
};

/// Watches a training; may be null functions.
struct Observer {
  std::function<void(std::size_t step, std::size_t steps, int epoch, double loss)>
      step;  // every 50 steps or so
  std::function<void(const EpochReport&, const Checkpoint&)> epoch;
  std::function<bool()> stop;  // asked after each step: true ends the training; the best model so far is kept
};

/// Trains on the acquisitions' label_dps, all of the same label. Deterministic: the same acquisitions,
/// configuration and instruction set give the same model, however many workers there are, and also when it
/// goes on from a checkpoint of the same training. Throws what check_data() throws, and Error(failed) when
/// the loss is not a number any more. Stopped before the first epoch ended, the model is the untrained one
/// and `epoch_kept` is 0. The model's `producer` is left to the caller.
TrainingResult train(const TrainingConfig& config, std::span<const network::Acquisition> acquisitions,
                     network::Workers& workers, const Observer& observer = {},
                     const std::optional<Checkpoint>& from = {});

}  // namespace thermorig::training
