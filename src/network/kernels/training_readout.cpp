// SPDX-License-Identifier: MIT
// The last layer of each head, forward and backward, and what is left of a step: biases, Adam on small
// tensors.
#include "training_adam.h"
#include "training_functions.h"

namespace thermorig::network::THERMORIG_KERNELS {

/// (count) to 1
void readout(const ReadoutJob& job) {
  Vector sums[vectors];
  for (int v = 0; v < vectors; ++v) sums[v] = splat(job.bias);
  for (int i = 0; i < job.count; ++i)
    for (int v = 0; v < vectors; ++v) sums[v] += job.weights[i] * load(job.input + i * cell + v * lanes);
  for (int v = 0; v < vectors; ++v) store(job.output + v * lanes, sums[v]);
}

/// 1 to (count), and the weights' own gradients
void readout_gradient(const ReadoutGradientJob& job) {
  Vector gradient[vectors];
  for (int v = 0; v < vectors; ++v) gradient[v] = load(job.gradient + v * lanes);
  *job.bias_gradient = sum_of_cell(job.gradient);
  for (int i = 0; i < job.count; ++i) {
    Vector sum{};
    for (int v = 0; v < vectors; ++v) {
      const Vector in = load(job.input + i * cell + v * lanes);
      sum += gradient[v] * in;
      store(job.input_gradient + i * cell + v * lanes, through_relu(job.weights[i] * gradient[v], in));
    }
    job.weight_gradient[i] = sum_of(sum);
  }
}

void sum_cells(const float* cells, int count, float* sums) {
  for (int i = 0; i < count; ++i) sums[i] = sum_of_cell(cells + static_cast<long>(i) * cell);
}

void adam(const AdamStep& step, int count, const float* gradient, float* weights, float* first_moment,
          float* second_moment) {
  for (int i = 0; i < count; i += lanes)
    adam_at(step, load(gradient + i), weights + i, first_moment + i, second_moment + i);
}

}  // namespace thermorig::network::THERMORIG_KERNELS
