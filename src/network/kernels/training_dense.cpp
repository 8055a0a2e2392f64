// SPDX-License-Identifier: MIT
// Fully connected layers, forward and backward with Adam (paper section III, Fig. 2). Weights lie in blocks
// of 32 features: (blocks, heads * head_rows, 32).
#include "training_adam.h"
#include "training_functions.h"

namespace thermorig::network::THERMORIG_KERNELS {

namespace {

constexpr int tile_rows = accumulators == 24 ? 10 : 5;  // two vectors of samples each
constexpr int pair = 2 * lanes;

/// Adds the features of one block to `tile_rows` outputs.
void add_block(const float* weights, const float* input, float* output, int v) {
  Vector sums[tile_rows][2];
  for (int r = 0; r < tile_rows; ++r)
    for (int i = 0; i < 2; ++i) sums[r][i] = load(output + r * cell + v + i * lanes);
  THERMORIG_KEEP_LOOP
  for (int k = 0; k < block; ++k) {
    const Vector in[2] = {load(input + k * cell + v), load(input + k * cell + v + lanes)};
    THERMORIG_UNROLL
    for (int r = 0; r < tile_rows; ++r) {
      const Vector weight = splat(weights[r * block + k]);
      sums[r][0] += weight * in[0];
      sums[r][1] += weight * in[1];
    }
  }
  for (int r = 0; r < tile_rows; ++r)
    for (int i = 0; i < 2; ++i) store(output + r * cell + v + i * lanes, sums[r][i]);
}

float* output_of(const DenseJob& job, int row) {
  return job.output + (static_cast<long>(row / job.head_rows) * job.head_cells + row % job.head_rows) * cell;
}

}  // namespace

/// (features) to (heads, head_rows), ReLU
void dense(const DenseJob& job, int first_tile, int last_tile) {
  const int first = first_tile * dense_tile, last = last_tile * dense_tile;
  for (int row = first; row < last; ++row) {
    const float bias = job.bias[row / job.head_rows][row % job.head_rows];
    for (int v = 0; v < cell; v += lanes) store(output_of(job, row) + v, splat(bias));
  }
  const long block_size = static_cast<long>(job.heads) * job.head_rows * block;
  for (int b = 0; b < job.blocks; ++b)
    for (int row = first; row < last; row += tile_rows)
      for (int v = 0; v < cell; v += pair)
        add_block(job.weights + b * block_size + static_cast<long>(row) * block,
                  job.input + static_cast<long>(b) * block * cell, output_of(job, row), v);
  for (int row = first; row < last; ++row)
    for (int v = 0; v < cell; v += lanes) store(output_of(job, row) + v, relu(load(output_of(job, row) + v)));
}

namespace {

/// Adds one head's part of the gradients of `features` inputs: sum over rows of weight * gradient.
template <int features>
void input_gradient_tile(const DenseGradientJob& job, const float* weights, const float* gradient, float* sum,
                         int v) {
  Vector sums[features][2];
  for (int f = 0; f < features; ++f)
    for (int i = 0; i < 2; ++i) sums[f][i] = load(sum + f * cell + v + i * lanes);
  THERMORIG_KEEP_LOOP
  for (int row = 0; row < job.head_rows; ++row) {
    const Vector of[2] = {load(gradient + row * cell + v), load(gradient + row * cell + v + lanes)};
    THERMORIG_UNROLL
    for (int f = 0; f < features; ++f) {
      const Vector weight = splat(weights[row * block + f]);
      sums[f][0] += weight * of[0];
      sums[f][1] += weight * of[1];
    }
  }
  for (int f = 0; f < features; ++f)
    for (int i = 0; i < 2; ++i) store(sum + f * cell + v + i * lanes, sums[f][i]);
}

/// The gradient of `tile_rows` x two vectors of weights: sum over samples; then Adam.
void weight_gradient_tile(const DenseGradientJob& job, long place, const float* gradient,
                          const float* samples) {
  Vector sums[tile_rows][2] = {};
  THERMORIG_KEEP_LOOP
  for (int s = 0; s < cell; ++s) {
    const Vector in[2] = {load(samples + s * block), load(samples + s * block + lanes)};
    THERMORIG_UNROLL
    for (int r = 0; r < tile_rows; ++r) {
      const Vector of = splat(gradient[r * cell + s]);
      sums[r][0] += of * in[0];
      sums[r][1] += of * in[1];
    }
  }
  for (int r = 0; r < tile_rows; ++r) {
    for (int i = 0; i < 2; ++i) {
      const long at = place + r * block + i * lanes;
      if (job.weight_gradient)
        store(job.weight_gradient + at, sums[r][i]);
      else
        adam_at(job.adam, sums[r][i], job.weights + at, job.first_moment + at, job.second_moment + at);
    }
  }
}

void transpose(const float* cells, float* samples) {
  for (int k = 0; k < block; ++k)
    for (int s = 0; s < cell; ++s) samples[s * block + k] = cells[k * cell + s];
}

void block_gradient(const DenseGradientJob& job, int b) {
  alignas(64) float sums[block * cell] = {};  // of the inputs
  alignas(64) float samples[cell * block];    // the inputs, samples outside
  const float* const input = job.input + static_cast<long>(b) * block * cell;
  transpose(input, samples);
  for (int head = 0; head < job.heads; ++head) {
    const float* const gradient = job.gradient + static_cast<long>(head) * job.head_cells * cell;
    const long place = (static_cast<long>(b) * job.heads + head) * job.head_rows * block;
    for (int v = 0; v < cell; v += pair)
      for (int f = 0; f < block; f += 4)
        input_gradient_tile<4>(job, job.weights + place + f, gradient, sums + f * cell, v);
    for (int row = 0; row < job.head_rows; row += tile_rows)
      for (int k = 0; k < block; k += pair)
        weight_gradient_tile(job, place + static_cast<long>(row) * block + k, gradient + row * cell,
                             samples + k);
  }
  for (int k = 0; k < block; ++k) {
    float* const out = job.input_gradient + static_cast<long>(job.cell_of[b * block + k]) * cell;
    for (int v = 0; v < cell; v += lanes)
      store(out + v, through_relu(load(sums + k * cell + v), load(input + k * cell + v)));
  }
}

}  // namespace

/// (heads, head_rows) to (features), and the weights' own gradients
void dense_gradient(const DenseGradientJob& job, int first_block, int last_block) {
  for (int b = first_block; b < last_block; ++b) block_gradient(job, b);
}

}  // namespace thermorig::network::THERMORIG_KERNELS
