// SPDX-License-Identifier: MIT
#include "thermorig/learning/training/prediction.h"

#include "batch_stream.h"
#include "estimates.h"

namespace thermorig::training {

std::vector<network::Output> estimates_of(const network::Weights& weights, const WindowSet& set) {
  std::vector<network::Output> outputs(set.size());
  if (set.size() == 0) return outputs;
  network::BatchEstimator estimator(weights);
  const EpochPlan plan = in_order(set.size());
  network::CallingThread worker;
  BatchStream batches(set, plan, network::max_batch, worker);
  for (std::size_t done = 0; done < set.size();) {
    const BatchBuffer& batch = batches.next();
    estimator.estimate(batch.batch(), std::span(outputs).subspan(done, batch.size()));
    done += batch.size();
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
