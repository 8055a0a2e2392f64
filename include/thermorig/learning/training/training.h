// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thermorig/network/acquisition.h"
#include "thermorig/network/model/model.h"
#include "thermorig/network/trainer.h"

namespace thermorig::training {

/// How a network is trained. Paper section III; what it leaves open is a setting.
struct TrainingConfig {
  std::string preset = "best";  // "paper", "best", or "custom" once anything differs from both
  network::Shape shape;
  int epochs = 40;
  int batch = 32;  // 1..32
  network::LossConfig loss;
  network::AdamConfig adam;
  bool mirror =
      false;  // half of the windows, drawn anew each epoch, flipped left to right with speed and gyro negated
  // Keep the epoch with the lowest error on one held-out training acquisition (fused plus, weighed as in the
  // loss, thermal); false: the last.
  bool choose_epoch = false;
  int history = 0;  // valid frames in a row that a window's end needs, see network::WindowRule
  std::uint64_t seed =
      1;  // of the first weights, of the order of windows, of the mirror and of the held-out acquisition
  float label_scale_dps = 200.0F;
};

/// Preset `paper`: to the letter (no auxiliary loss, no mirror, last epoch). Preset `best`: auxiliary thermal
/// loss, mirror, epoch chosen on a held-out acquisition. Throws Error(bad_usage) for another name.
TrainingConfig preset(const std::string& name);

/// "paper" or "best" if everything that a preset fixes is as it has it, else "custom". Shape, seed and
/// `history` are not what a preset fixes.
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
