// SPDX-License-Identifier: MIT
#include "thermorig/learning/training/prediction.h"

#include <algorithm>

#include "batch_stream.h"
#include "estimates.h"
#include "thermorig/core/error.h"
#include "thermorig/network/turn.h"

namespace thermorig::training {

std::vector<network::Output> estimates_of(const network::Weights& weights, const WindowSet& set,
                                          network::Turn turn) {
  std::vector<network::Output> outputs(set.size());
  if (set.size() == 0) return outputs;
  network::BatchEstimator estimator(weights);
  EpochPlan plan = in_order(set.size());
  std::fill(plan.turns.begin(), plan.turns.end(), turn.bits());
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

namespace {

std::vector<network::Output> turned_estimates(const network::Weights& weights, const WindowSet& set) {
  const bool fusion = weights.shape.fusion;
  std::vector<network::TurnedOutputs> sums(set.size());
  for (std::uint8_t bits = 0; bits < network::Turn::all; ++bits) {
    const network::Turn turn(bits);
    const std::vector<network::Output> outputs = estimates_of(weights, set, turn);
    for (std::size_t index = 0; index < set.size(); ++index) sums[index].add(outputs[index], turn, fusion);
  }
  std::vector<network::Output> means;
  means.reserve(set.size());
  for (std::size_t index = 0; index < set.size(); ++index)
    means.push_back(sums[index].mean(set.gyro(index), fusion));
  return means;
}

void check_turned(const model::Model& model, int turned) {
  if (turned == 1) return;
  if (turned != network::Turn::all || !model.scaling.by_window)
    throw Error(ExitCode::bad_usage, "this network has not learnt windows that are upside down or backwards",
                "the model", "--turned 1, or a model of preset best");
}

}  // namespace

std::vector<WindowEstimate> predict(const model::Model& model,
                                    std::span<const network::Acquisition> acquisitions,
                                    std::span<const network::Window> windows, int turned) {
  check_turned(model, turned);
  const WindowSet set(acquisitions, {windows.begin(), windows.end()}, model.weights.shape, model.scaling);
  const std::vector<network::Output> outputs =
      turned == 1 ? estimates_of(model.weights, set) : turned_estimates(model.weights, set);
  std::vector<WindowEstimate> estimates;
  estimates.reserve(set.size());
  for (std::size_t index = 0; index < set.size(); ++index) {
    const float scale_dps = set.speed_scale_dps(index);
    estimates.push_back({.window = set.window(index),
                         .label_dps = set.rates(index).label_dps,
                         .gyro_dps = set.rates(index).gyro_dps,
                         .thermal_dps = outputs[index].thermal * scale_dps,
                         .fusion_dps = outputs[index].fusion * scale_dps,
                         .gain = outputs[index].gain});
    if (model.scaling.gate_states_sigma)
      estimates.back().thermal_sigma_dps =
          scale_dps * static_cast<float>(network::gate_sigma(outputs[index].gain, network::gate_gyro_sigma));
  }
  return estimates;
}

}  // namespace thermorig::training
