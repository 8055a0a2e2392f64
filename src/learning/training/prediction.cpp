// SPDX-License-Identifier: MIT
#include "thermorig/learning/training/prediction.h"

#include <algorithm>

#include "estimates.h"

namespace thermorig::training {

std::vector<network::Output> estimates_of(const network::Weights& weights, const WindowSet& set) {
  std::vector<network::Output> outputs(set.size());
  if (set.size() == 0) return outputs;
  network::BatchEstimator estimator(weights);
  BatchBuffer buffer(set);
  for (std::size_t begin = 0; begin < set.size(); begin += network::max_batch) {
    const std::size_t end = std::min(set.size(), begin + network::max_batch);
    buffer.clear();
    for (std::size_t index = begin; index < end; ++index) buffer.add(index);
    estimator.estimate(buffer.batch(), std::span(outputs).subspan(begin, end - begin));
  }
  return outputs;
}

SquaredErrors squared_errors(const network::Weights& weights, const WindowSet& set) {
  const std::vector<network::Output> outputs = estimates_of(weights, set);
  SquaredErrors sums;
  for (std::size_t index = 0; index < set.size(); ++index) {
    const double fusion = outputs[index].fusion - set.label(index);
    const double thermal = outputs[index].thermal - set.label(index);
    sums.fusion += fusion * fusion;
    sums.thermal += thermal * thermal;
  }
  const auto count = static_cast<double>(set.size());
  return {sums.fusion / count, sums.thermal / count};
}

std::vector<WindowEstimate> predict(const model::Model& model,
                                    std::span<const network::Acquisition> acquisitions,
                                    std::span<const network::Window> windows) {
  const WindowSet set(acquisitions, {windows.begin(), windows.end()}, model.weights.shape, model.scaling);
  const std::vector<network::Output> outputs = estimates_of(model.weights, set);
  const float scale_dps = model.scaling.label_scale_dps;
  std::vector<WindowEstimate> estimates;
  estimates.reserve(set.size());
  for (std::size_t index = 0; index < set.size(); ++index)
    estimates.push_back({.window = set.window(index),
                         .label_dps = set.rates(index).label_dps,
                         .gyro_dps = set.rates(index).gyro_dps,
                         .thermal_dps = outputs[index].thermal * scale_dps,
                         .fusion_dps = outputs[index].fusion * scale_dps,
                         .gain = outputs[index].gain});
  return estimates;
}

}  // namespace thermorig::training
