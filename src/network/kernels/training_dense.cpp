// SPDX-License-Identifier: MIT
// Fully connected layers, forward and backward with Adam (paper section III, Fig. 2). Weights lie in blocks
// of 32 features: (blocks, heads * head_rows, 32). Those of the first layer do not fit the second cache:
// every loop fetches ahead of itself.
#include "training_adam.h"
#include "training_functions.h"
#include "training_transpose.h"

namespace thermorig::network::THERMORIG_KERNELS {

namespace {

constexpr int pair = 2 * lanes;  // tiles are two vectors wide
constexpr int tile_rows = accumulators >= 20 ? 10 : 5;
constexpr int blocks_together = 6;  // their inputs, 24 KiB, stay in the first cache
constexpr int turns_together = 8;   // of a loop: of few turns, processors foresee the end

void fetch(const float* at) {
  __builtin_prefetch(at, 0, 2);  // to the second cache
}

void fetch_near(const float* at) {
  __builtin_prefetch(at, 0, 3);  // to the first
}

/// Adds the features of some blocks to `tile_rows` outputs of a head, two vectors of samples; with the first
/// of them begins with the bias, with the last ends with ReLU.
THERMORIG_TILE void add_blocks(const DenseJob& job, int head, int head_row, int first_block, int last_block,
                               int v) {
  const int row = head * job.head_rows + head_row;
  const long block_size = static_cast<long>(job.heads) * job.head_rows * block;
  float* const output = job.output + (static_cast<long>(head) * job.head_cells + head_row) * cell + v;
  Vector sums[tile_rows][2];
  if (first_block == 0) {
    const float* const bias = job.bias[head] + head_row;
    THERMORIG_UNROLL
    for (int r = 0; r < tile_rows; ++r) sums[r][0] = sums[r][1] = splat(bias[r]);
  } else {
    load_tile(sums, output, cell, lanes);
  }
  for (int b = first_block; b < last_block; ++b) {
    const float* const weights = job.weights + b * block_size + static_cast<long>(row) * block;
    const float* const input = job.input + static_cast<long>(b) * block * cell + v;
    const float* const ahead = weights + blocks_together * block_size;
    THERMORIG_KEEP_LOOP
    for (int k = 0; k < block; k += turns_together) {
      THERMORIG_UNROLL
      for (int turn = k; turn < k + turns_together; ++turn) {
        fetch(ahead + turn * tile_rows);
        fetch_near(weights + block_size + turn * tile_rows);
        const Vector in[2] = {load(input + turn * cell), load(input + turn * cell + lanes)};
        THERMORIG_UNROLL
        for (int r = 0; r < tile_rows; ++r) {
          const Vector weight = splat(weights[r * block + turn]);
          sums[r][0] += weight * in[0];
          sums[r][1] += weight * in[1];
        }
      }
    }
  }
  if (last_block == job.blocks) {
    THERMORIG_UNROLL
    for (int r = 0; r < tile_rows; ++r) {
      sums[r][0] = relu(sums[r][0]);
      sums[r][1] = relu(sums[r][1]);
    }
  }
  store_tile(sums, output, cell, lanes);
}

}  // namespace

/// (features) to (heads, head_rows), ReLU
void dense(const DenseJob& job, int first_tile, int last_tile) {
  for (int b = 0; b < job.blocks; b += blocks_together) {
    const int end = b + blocks_together < job.blocks ? b + blocks_together : job.blocks;
    for (int row = first_tile * dense_tile; row < last_tile * dense_tile; row += tile_rows)
      for (int v = 0; v < cell; v += pair)
        add_blocks(job, row / job.head_rows, row % job.head_rows, b, end, v);
  }
}

namespace {

/// A head's part of a block: (head_rows, 32) weights and as many of each moment from `place` on, (head_rows)
/// cells of gradient.
struct HeadBlock {
  const DenseGradientJob& job;
  long place;
  const float* gradient;
  long size() const { return static_cast<long>(job.head_rows) * block; }
};

constexpr int feature_tiles = (block + accumulators / 2 - 1) / (accumulators / 2);
constexpr int feature_passes = feature_tiles * (cell / pair);

/// Adds to the gradients of the features of a tile, two vectors of samples: the sum over rows of weight *
/// gradient. Fetches the next part's weights and first moments.
template <int tile>
THERMORIG_TILE void input_gradient(const HeadBlock& part, float* input_gradients, int v) {
  constexpr int first = tile * block / feature_tiles;
  constexpr int features = (tile + 1) * block / feature_tiles - first;
  constexpr int step = (block + feature_passes - 1) / feature_passes;
  const float* const weights = part.job.weights + part.place + first;
  const float* const gradient = part.gradient + v;
  const long ahead = part.place + part.size() + (v / pair * feature_tiles + tile) * part.job.head_rows * step;
  const float* next_weights = part.job.weights + ahead;
  const float* next_moments = part.job.first_moment + ahead;
  float* const out = input_gradients + first * cell + v;
  Vector sums[features][2];
  load_tile(sums, out, cell, lanes);
  THERMORIG_KEEP_LOOP
  for (int row = 0; row < part.job.head_rows; ++row) {
    fetch(next_weights + row * step);
    fetch(next_moments + row * step);
    const Vector of[2] = {load(gradient + row * cell), load(gradient + row * cell + lanes)};
    THERMORIG_UNROLL
    for (int f = 0; f < features; ++f) {
      const Vector weight = splat(weights[row * block + f]);
      sums[f][0] += weight * of[0];
      sums[f][1] += weight * of[1];
    }
  }
  store_tile(sums, out, cell, lanes);
}

template <int tile = 0>
void input_gradients(const HeadBlock& part, float* gradients) {
  for (int v = 0; v < cell; v += pair) input_gradient<tile>(part, gradients, v);
  if constexpr (tile + 1 < feature_tiles) input_gradients<tile + 1>(part, gradients);
}

/// The gradient of `tile_rows` x two vectors of weights: the sum over samples; then `use`(place, gradient)
/// for each vector. Fetches the next part's second moments.
template <class Use>
THERMORIG_TILE void weight_gradient(const HeadBlock& part, int row, int k, const float* samples, Use use) {
  constexpr int step = (tile_rows * pair + cell - 1) / cell;
  const DenseGradientJob& job = part.job;
  const long place = part.place + static_cast<long>(row) * block + k;
  const float* const next = job.second_moment + part.place + part.size() + static_cast<long>(row) * block +
                            static_cast<long>(k) * tile_rows;
  const float* const gradient = part.gradient + row * cell;
  Vector sums[tile_rows][2] = {};
  THERMORIG_KEEP_LOOP
  for (int begin = 0; begin < cell; begin += turns_together) {
    THERMORIG_UNROLL
    for (int s = begin; s < begin + turns_together; ++s) {
      fetch(next + s * step);
      fetch_near(job.first_moment + place + s * step);
      fetch_near(job.second_moment + place + s * step);
      const Vector in[2] = {load(samples + s * block + k), load(samples + s * block + k + lanes)};
      THERMORIG_UNROLL
      for (int r = 0; r < tile_rows; ++r) {
        const Vector of = splat(gradient[r * cell + s]);
        sums[r][0] += of * in[0];
        sums[r][1] += of * in[1];
      }
    }
  }
  THERMORIG_UNROLL
  for (int r = 0; r < tile_rows; ++r) {
    THERMORIG_UNROLL
    for (int i = 0; i < 2; ++i) use(place + r * block + i * lanes, sums[r][i]);
  }
}

template <class Use>
void weight_gradients(const HeadBlock& part, const float* samples, Use use) {
  for (int row = 0; row < part.job.head_rows; row += tile_rows)
    for (int k = 0; k < block; k += pair) weight_gradient(part, row, k, samples, use);
}

void block_gradient(const DenseGradientJob& job, int b) {
  alignas(64) float gradients[block * cell] = {};  // of the inputs
  alignas(64) float samples[cell * block];         // the inputs, samples outside
  const float* const input = job.input + static_cast<long>(b) * block * cell;
  transpose(input, samples, cell);
  for (int head = 0; head < job.heads; ++head) {
    const HeadBlock part{job, (static_cast<long>(b) * job.heads + head) * job.head_rows * block,
                         job.gradient + static_cast<long>(head) * job.head_cells * cell};
    input_gradients(part, gradients);
    if (job.weight_gradient)
      weight_gradients(part, samples,
                       [to = job.weight_gradient](long place, Vector sum) { store(to + place, sum); });
    else
      weight_gradients(part, samples,
                       [weights = job.weights, first = job.first_moment, second = job.second_moment,
                        adam = job.adam](long place, Vector sum) {
                         adam_at(adam, sum, weights + place, first + place, second + place);
                       });
  }
  for (int k = 0; k < block; ++k) {
    float* const out = job.input_gradient + job.place_of[b * block + k];
    for (int v = 0; v < cell; v += lanes)
      store(out + v, through_relu(load(gradients + k * cell + v), load(input + k * cell + v)));
  }
}

}  // namespace

/// (heads, head_rows) to (features), and the weights' own gradients
void dense_gradient(const DenseGradientJob& job, int first_block, int last_block) {
  for (int b = first_block; b < last_block; ++b) block_gradient(job, b);
}

}  // namespace thermorig::network::THERMORIG_KERNELS
