// SPDX-License-Identifier: MIT
#include "thermorig/learning/study/evaluation.h"

#include <algorithm>
#include <cassert>
#include <map>

#include "angle_integral.h"
#include "bound_errors.h"
#include "error_statistics.h"
#include "gain_statistics.h"

namespace thermorig::study {

namespace {

PerEstimator<Errors> errors_of(std::span<const JudgedWindow> judged, double label_scale_dps,
                               float JudgedWindow::*truth_dps = &JudgedWindow::label_dps) {
  PerEstimator<Errors> errors;
  for (const std::string& name : all_estimators()) {
    ErrorStatistics statistics;
    for (const JudgedWindow& one : judged)
      statistics.add(double{one.rate_dps[name]} - double{one.*truth_dps});
    errors[name] = statistics.errors(label_scale_dps);
  }
  return errors;
}

std::vector<EnvironmentErrors> errors_by_environment(std::span<const JudgedWindow> judged,
                                                     std::span<const network::Acquisition> acquisitions,
                                                     double label_scale_dps) {
  std::map<std::string, std::vector<JudgedWindow>> parts;
  std::map<std::string, std::size_t> counts;
  for (const network::Acquisition& acquisition : acquisitions) ++counts[acquisition.environment];
  for (const JudgedWindow& one : judged)
    parts[acquisitions[one.window.acquisition].environment].push_back(one);
  std::vector<EnvironmentErrors> environments;
  for (const auto& [name, count] : counts)
    environments.push_back({name, count, errors_of(parts[name], label_scale_dps),
                            errors_of(parts[name], label_scale_dps, &JudgedWindow::shaft_dps),
                            gate_sigma(parts[name])});
  return environments;
}

std::span<const JudgedWindow> part_of(std::span<const JudgedWindow> judged, std::size_t acquisition) {
  const auto of = [](const JudgedWindow& one) { return one.window.acquisition; };
  return {std::ranges::lower_bound(judged, acquisition, {}, of),
          std::ranges::upper_bound(judged, acquisition, {}, of)};
}

}  // namespace

Evaluation evaluate(std::span<const JudgedWindow> judged, std::span<const network::Acquisition> acquisitions,
                    const EvaluationConfig& config) {
  assert(config.label_scale_dps > 0.0);
  Evaluation evaluation;
  evaluation.errors = errors_of(judged, config.label_scale_dps);
  evaluation.shaft_errors = errors_of(judged, config.label_scale_dps, &JudgedWindow::shaft_dps);
  evaluation.environments = errors_by_environment(judged, acquisitions, config.label_scale_dps);
  evaluation.speeds = speed_errors(judged, acquisitions, config.label_scale_dps);
  evaluation.gain = gain_statistics(judged);
  evaluation.sigma = gate_sigma(judged);
  evaluation.bounds = bound_errors(judged);
  for (std::size_t i = 0; i < acquisitions.size(); ++i) {
    evaluation.angles.push_back(angle_track(part_of(judged, i), acquisitions[i], config.angle_points));
    evaluation.names.push_back(acquisitions[i].name);
    evaluation.simulated = evaluation.simulated || acquisitions[i].simulated;
  }
  return evaluation;
}

}  // namespace thermorig::study
