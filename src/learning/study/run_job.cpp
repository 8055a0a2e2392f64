// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>

#include "left_out.h"
#include "thermorig/learning/study/study.h"

namespace thermorig::study {

namespace {

using network::Acquisition;

training::TrainingConfig config_of(const Job& job) {
  training::TrainingConfig config = training::preset(job.preset);
  config.shape.frames = job.frames;
  config.shape.reduction = job.reduction;
  config.shape.fusion = job.fusion;
  config.epochs = job.epochs;
  config.history = job.history;
  config.seed = job.seed;
  return config;
}

std::vector<Acquisition> rest_of(const Acquisition& test, std::span<const Acquisition> acquisitions) {
  std::vector<Acquisition> rest;
  rest.reserve(acquisitions.size() - 1);
  for (const Acquisition& acquisition : acquisitions)
    if (&acquisition != &test) rest.push_back(acquisition);
  return rest;
}

/// What the epochs left in a result.
void take_training(JobResult& result, const training::TrainingResult& training) {
  for (const training::EpochReport& epoch : training.epochs)
    result.training_mse.push_back(epoch.training_mse);
  result.training_windows = training.windows;
  result.epoch_kept = training.model.provenance.epoch_kept;
  result.weights = network::weight_count(training.model.weights.shape);
  result.multiply_adds = network::multiply_adds(training.model.weights.shape);
  result.label_scale_dps = double{training.model.scaling.label_scale_dps};
}

}  // namespace

std::optional<JobResult> run_job(const Job& job, std::span<const Acquisition> acquisitions,
                                 const training::Observer& observer) {
  const auto begin = std::chrono::steady_clock::now();
  const Acquisition& left_out = left_out_of(job, acquisitions);
  const std::vector<Acquisition> rest = rest_of(left_out, acquisitions);
  network::CallingThread workers;
  const training::TrainingResult training = training::train(config_of(job), rest, workers, observer);
  if (training.stopped) return std::nullopt;
  JobResult result;
  result.job = job;
  take_training(result, training);
  result.simulated = std::any_of(acquisitions.begin(), acquisitions.end(),
                                 [](const Acquisition& acquisition) { return acquisition.simulated; });
  result.instruction_set = network::name_of(network::best_instruction_set());
  const auto judged = judged_windows(training.model, {&left_out, 1}, test_windows(job, left_out));
  result.evaluation = evaluation_of(judged, left_out, result.label_scale_dps);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace thermorig::study
