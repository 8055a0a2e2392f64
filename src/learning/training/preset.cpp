// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <tuple>

#include "thermorig/core/error.h"
#include "thermorig/learning/training/training.h"

namespace thermorig::training {

namespace {

/// What a preset fixes.
auto settings_of(const TrainingConfig& config) {
  const network::AdamConfig& adam = config.adam;
  return std::tuple(config.epochs, config.batch, config.loss.berhu_fraction, config.loss.auxiliary_thermal,
                    config.loss.likelihood, adam.rate, adam.beta1, adam.beta2, adam.epsilon, adam.wide_rate,
                    config.cosine, config.symmetries, config.window_scaling, config.choose_epoch,
                    config.label_scale_dps);
}

[[noreturn]] void refuse(const std::string& what, const std::string& advice) {
  throw Error(ExitCode::bad_usage, what, "", advice);
}

}  // namespace

TrainingConfig preset(const std::string& name) {
  TrainingConfig config;
  config.preset = name;
  if (name == "paper") return config;
  if (name != "best")
    refuse(fmt::format("there is no preset \"{}\"", name), "--preset best, or --preset paper");
  config.loss.likelihood = true;
  config.adam.rate = 0.002F;
  config.adam.wide_rate = 0.05F;
  config.cosine = true;
  config.symmetries = 8;
  config.window_scaling = true;
  return config;
}

std::string preset_of(const TrainingConfig& config) {
  for (const char* name : {"paper", "best"})
    if (settings_of(config) == settings_of(preset(name))) return name;
  return "custom";
}

void check(const TrainingConfig& config) {
  if (const auto fault = network::fault_of(config.shape)) refuse(*fault, "--nf 3 --nr 1");
  if (config.epochs < 1 || config.epochs > 100'000)
    refuse("the number of epochs is 1 to 100,000", "--epochs 40");
  if (config.batch < 1 || config.batch > network::max_batch)
    refuse(fmt::format("a batch has 1 to {} windows", network::max_batch), "--batch 32");
  if (!(config.adam.rate > 0.0F && config.adam.rate <= 1.0F))
    refuse("the learning rate lies above 0 and is 1 at most", "--rate 0.001");
  if (!(config.loss.auxiliary_thermal >= 0.0F && config.loss.auxiliary_thermal <= 1000.0F))
    refuse("the weight of the auxiliary thermal loss is 0 to 1000", "--auxiliary-thermal 0.5");
  if (config.symmetries != 1 && config.symmetries != 2 && config.symmetries != 8)
    refuse("a window has 1, 2 or 8 symmetries", "--symmetries 8");
  if (config.made.windows < 0 || config.made.windows > config.batch)
    refuse("made-up windows are a part of a batch, or all of it", "--made-rooms, without a number");
  if (config.made.rounds_kept < 1 || config.made.rounds_kept > 1000 || config.made.steps_an_epoch < 1)
    refuse("made-up rooms are kept for 1 to 1,000 rounds, and an epoch has a step",
           "the settings as they are");
  if (config.from && config.from->weights.shape != config.shape)
    refuse("a training begins with a network of its own shape", "--from none");
  if (config.made.windows > 0 && !config.window_scaling)
    refuse("made-up rooms have no mean temperature that a data set could be scaled by",
           "--preset best, which scales each window by itself");
  if (!(config.label_scale_dps >= 1e-3F && config.label_scale_dps <= 1e6F))
    refuse("the label scale is 0.001 to 1,000,000 deg/s", "--label-scale 200");
}

}  // namespace thermorig::training
