// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <tuple>

#include "thermorig/core/error.h"
#include "thermorig/learning/training/training.h"

namespace thermorig::training {

namespace {

constexpr float best_auxiliary_thermal = 0.5F;

/// What a preset fixes.
auto settings_of(const TrainingConfig& config) {
  const network::AdamConfig& adam = config.adam;
  return std::tuple(config.epochs, config.batch, config.loss.berhu_fraction, config.loss.auxiliary_thermal,
                    adam.rate, adam.beta1, adam.beta2, adam.epsilon, config.mirror, config.choose_epoch,
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
  config.loss.auxiliary_thermal = best_auxiliary_thermal;
  config.mirror = true;
  config.choose_epoch = true;
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
  if (!(config.label_scale_dps >= 1e-3F && config.label_scale_dps <= 1e6F))
    refuse("the label scale is 0.001 to 1,000,000 deg/s", "--label-scale 200");
}

}  // namespace thermorig::training
