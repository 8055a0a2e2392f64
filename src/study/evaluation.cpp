// SPDX-License-Identifier: MIT
#include "thermorig/study/evaluation.h"

#include <cassert>
#include <map>

#include "angle_integral.h"
#include "error_statistics.h"
#include "estimates.h"
#include "gain_statistics.h"

namespace thermorig::study {

namespace {

using training::WindowEstimate;

std::array<Errors, estimator_count> errors_of(std::span<const WindowEstimate> estimates,
                                              std::span<const windows::Acquisition> acquisitions,
                                              const EvaluationConfig& config) {
  std::array<Errors, estimator_count> errors;
  for (const Estimator estimator : all_estimators) {
    ErrorStatistics statistics(config.label_scale_dps);
    for (const WindowEstimate& estimate : estimates)
      statistics.add(speed_of(estimate, estimator, acquisitions, config.fusion) - double{estimate.label_dps});
    errors[index_of(estimator)] = statistics.errors();
  }
  return errors;
}

std::vector<EnvironmentErrors> errors_by_environment(std::span<const WindowEstimate> estimates,
                                                     std::span<const windows::Acquisition> acquisitions,
                                                     const EvaluationConfig& config) {
  std::map<std::string, std::vector<WindowEstimate>> parts;
  std::map<std::string, std::size_t> counts;
  for (const windows::Acquisition& acquisition : acquisitions) ++counts[acquisition.environment];
  for (const WindowEstimate& estimate : estimates)
    parts[acquisitions[estimate.window.acquisition].environment].push_back(estimate);
  std::vector<EnvironmentErrors> environments;
  for (const auto& [name, count] : counts)
    environments.push_back({name, count, errors_of(parts[name], acquisitions, config)});
  return environments;
}

/// The windows of acquisition `index`; they stand together.
std::span<const WindowEstimate> part_of(std::span<const WindowEstimate> estimates, std::size_t index) {
  std::size_t begin = 0;
  while (begin < estimates.size() && estimates[begin].window.acquisition != index) ++begin;
  std::size_t end = begin;
  while (end < estimates.size() && estimates[end].window.acquisition == index) ++end;
  return estimates.subspan(begin, end - begin);
}

}  // namespace

std::string name_of(Estimator estimator) {
  switch (estimator) {
    case Estimator::thermal:
      return "thermal-only";
    case Estimator::fusion:
      return "fusion";
    case Estimator::gyro:
      return "gyro";
    case Estimator::gyro_unbiased:
      return "gyro, static bias removed";
  }
  return "";
}

std::string field_name_of(Estimator estimator) {
  switch (estimator) {
    case Estimator::thermal:
      return "thermal";
    case Estimator::fusion:
      return "fusion";
    case Estimator::gyro:
      return "gyro";
    case Estimator::gyro_unbiased:
      return "gyro_unbiased";
  }
  return "";
}

Evaluation evaluate(std::span<const WindowEstimate> estimates,
                    std::span<const windows::Acquisition> acquisitions, const EvaluationConfig& config) {
  assert(config.label_scale_dps > 0.0);
  Evaluation evaluation;
  evaluation.errors = errors_of(estimates, acquisitions, config);
  evaluation.environments = errors_by_environment(estimates, acquisitions, config);
  evaluation.speeds = speed_errors(estimates, acquisitions, config);
  evaluation.gain = config.fusion ? gain_statistics(estimates) : gain_statistics({});
  for (std::size_t i = 0; i < acquisitions.size(); ++i) {
    evaluation.angles.push_back(angle_track(part_of(estimates, i), acquisitions, config));
    evaluation.names.push_back(acquisitions[i].name);
    evaluation.simulated = evaluation.simulated || acquisitions[i].simulated;
  }
  return evaluation;
}

}  // namespace thermorig::study
