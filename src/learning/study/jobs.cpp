// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "fingerprint.h"
#include "thermorig/core/error.h"
#include "thermorig/learning/study/study.h"

namespace thermorig::study {

namespace {

using network::Acquisition;

/// One setting of the study; each is run for all folds and set-ups.
struct Setting {
  int frames = 0;
  int reduction = 0;
  std::uint64_t seed = 0;
  auto operator<=>(const Setting&) const = default;
};

std::vector<const Acquisition*> folds_of(const std::string& environment,
                                         std::span<const Acquisition> acquisitions) {
  std::vector<const Acquisition*> folds;
  for (const Acquisition& acquisition : acquisitions)
    if (acquisition.environment == environment) folds.push_back(&acquisition);
  std::sort(folds.begin(), folds.end(),
            [](const Acquisition* a, const Acquisition* b) { return a->name < b->name; });
  return folds;
}

std::string environments_of(std::span<const Acquisition> acquisitions) {
  std::set<std::string> names;
  for (const Acquisition& acquisition : acquisitions) names.insert(acquisition.environment);
  return fmt::format("{}", fmt::join(names, ", "));
}

void check_folds(const std::vector<const Acquisition*>& folds, const StudyConfig& config,
                 std::span<const Acquisition> acquisitions) {
  if (folds.size() < 2)
    throw Error(
        ExitCode::bad_usage,
        fmt::format("leaving one acquisition out needs at least two of the environment {}, there {} {}",
                    config.environment, folds.size() == 1 ? "is" : "are", folds.size()),
        "", fmt::format("--environment with one of: {}", environments_of(acquisitions)));
}

void check_names(std::span<const Acquisition> acquisitions) {
  std::set<std::string> names;
  for (const Acquisition& acquisition : acquisitions)
    if (!names.insert(acquisition.name).second)
      throw Error(ExitCode::bad_usage, "two acquisitions have the same name", acquisition.name,
                  "leave one of them out");
}

/// All settings, the reference first, each once.
std::vector<Setting> settings_in_order(const StudyConfig& config) {
  std::vector<Setting> settings;
  const auto add = [&](int frames, int reduction, std::uint64_t seed) {
    const Setting setting{frames, reduction, seed};
    if (std::find(settings.begin(), settings.end(), setting) == settings.end()) settings.push_back(setting);
  };
  for (const std::uint64_t seed : config.seeds)
    add(config.reference_frames, config.reference_reduction, seed);
  for (const std::uint64_t seed : config.seeds) {
    for (const int frames : config.frames) add(frames, config.reference_reduction, seed);
    for (const int reduction : config.reductions) add(config.reference_frames, reduction, seed);
  }
  for (const std::uint64_t seed : config.reference_seeds)
    add(config.reference_frames, config.reference_reduction, seed);
  return settings;
}

void check_settings(const std::vector<Setting>& settings, const StudyConfig& config) {
  for (const Setting& setting : settings) {
    network::Shape shape;
    shape.frames = setting.frames;
    shape.reduction = setting.reduction;
    if (const std::optional<std::string> fault = network::fault_of(shape))
      throw Error(ExitCode::bad_usage, *fault, "", "--nf 2..6, --nr 1..3");
  }
  if (settings.empty()) throw Error(ExitCode::bad_usage, "a study needs at least one seed", "", "--seeds 1");
  if (config.epochs < 1)
    throw Error(ExitCode::bad_usage, "a training needs at least one epoch", "", "--epochs 40");
}

int history_of(const StudyConfig& config) {
  int history = std::max(config.history, config.reference_frames);
  for (const int frames : config.frames) history = std::max(history, frames);
  return history;
}

Job job_of(const Setting& setting, const StudyConfig& config, int history) {
  Job job;
  job.frames = setting.frames;
  job.reduction = setting.reduction;
  job.seed = setting.seed;
  job.preset = config.preset;
  job.settings = settings_of(training::preset(config.preset));
  job.epochs = config.epochs;
  job.history = history;
  return job;
}

}  // namespace

std::string settings_of(const training::TrainingConfig& config) {
  std::string text = fmt::format(
      "batch {}, berhu {}, auxiliary {}, rate {}, beta1 {}, beta2 {}, epsilon {}, mirror {}, choose epoch "
      "{}, "
      "label scale {}",
      config.batch, config.loss.berhu_fraction, config.loss.auxiliary_thermal, config.adam.rate,
      config.adam.beta1, config.adam.beta2, config.adam.epsilon, config.symmetries == 2, config.choose_epoch,
      config.label_scale_dps);
  if (config.symmetries == 8) text += ", 8 symmetries";
  if (config.window_scaling) text += ", scaled by the window";
  if (config.loss.likelihood) text += ", likelihood";
  if (config.cosine) text += fmt::format(", cosine, wide layers {}", config.adam.wide_rate);
  return text;
}

std::string description_of(const Job& job) {
  return fmt::format("{}, Nf {}, Nr {}, {}, seed {}", job.test, job.frames, job.reduction,
                     job.fusion ? "fusion" : "thermal-only", job.seed);
}

std::vector<Job> jobs_of(const StudyConfig& config, std::span<const Acquisition> acquisitions) {
  check_names(acquisitions);
  const std::vector<const Acquisition*> folds = folds_of(config.environment, acquisitions);
  check_folds(folds, config, acquisitions);
  const std::vector<Setting> settings = settings_in_order(config);
  check_settings(settings, config);
  const std::string data_hash = fingerprint_of(acquisitions);
  std::vector<Job> jobs;
  for (const Setting& setting : settings) {
    Job job = job_of(setting, config, history_of(config));
    job.data_hash = data_hash;
    job.label = acquisitions.front().label;
    for (const Acquisition* fold : folds) {
      job.test = fold->name;
      job.test_hash = fold->hash;
      for (const bool fusion : {true, false}) {
        job.fusion = fusion;
        if (fusion ? config.fusion : config.thermal_only) jobs.push_back(job);
      }
    }
  }
  return jobs;
}

}  // namespace thermorig::study
