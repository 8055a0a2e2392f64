// SPDX-License-Identifier: MIT
#include "train_config.h"

namespace thermorig::app {

training::TrainingConfig training_config(const TrainOptions& options) {
  training::TrainingConfig config = training::preset(options.preset);
  config.shape.frames = options.frames.value_or(config.shape.frames);
  config.shape.reduction = options.reduction.value_or(config.shape.reduction);
  config.shape.fusion = options.fusion;
  config.epochs = options.epochs.value_or(config.epochs);
  config.batch = options.batch.value_or(config.batch);
  if (options.rate) config.adam.rate = static_cast<float>(*options.rate);
  if (options.auxiliary_thermal)
    config.loss.auxiliary_thermal = static_cast<float>(*options.auxiliary_thermal);
  if (options.label_scale_dps) config.label_scale_dps = static_cast<float>(*options.label_scale_dps);
  config.mirror = options.mirror.value_or(config.mirror);
  config.choose_epoch = options.choose_epoch.value_or(config.choose_epoch);
  config.seed = options.seed;
  config.preset = training::preset_of(config);
  training::check(config);
  return config;
}

}  // namespace thermorig::app
