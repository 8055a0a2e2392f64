// SPDX-License-Identifier: MIT
#include "batch_network.h"

#include <cassert>
#include <cmath>

namespace thermorig::network {

static_assert(taps == kernel_size && cell == max_batch);
static_assert(filters1 == conv1_tile && filters1 == conv2_input_tile && filters2 % conv2_tile == 0);
static_assert(hidden1 % dense_tile == 0 && hidden2 % dense_tile == 0);

const TrainingKernels& training_kernels([[maybe_unused]] InstructionSet set) {
#ifdef THERMORIG_X86_64_KERNELS
  if (set == InstructionSet::avx512) return avx512::training_kernels;
  if (set == InstructionSet::avx2) return avx2::training_kernels;
#endif
  return baseline::training_kernels;
}

void pack_convolution(const float* weights, int outputs, int inputs, int tile, float* packed) {
  constexpr int window = taps * taps;
  for (int group = 0; group < outputs; group += tile)
    for (int i = 0; i < inputs * window; ++i)
      for (int o = 0; o < tile; ++o) *packed++ = weights[(group + o) * inputs * window + i];
}

BatchNetwork::BatchNetwork(const Weights& weights, InstructionSet set)
    : input(weights.shape.frames, weights.shape.rows(), weights.shape.columns(), weights.shape.padding1),
      pooled(filters1, weights.shape.pooled_rows(), weights.shape.pooled_columns(), weights.shape.padding2),
      features(static_cast<std::size_t>(BatchLayout(weights.shape).blocks() * block * cell)),
      hidden_first(2 * head_cells * cell),
      hidden_second(hidden2 * cell),
      thermal(cell),
      gain(cell),
      shape_(weights.shape),
      layout_(weights.shape),
      kernels_(&training_kernels(set)),
      weights_(layout_.size()),
      conv1_weights_(static_cast<std::size_t>(filters1 * shape_.frames * taps * taps)),
      conv2_weights_(filters2 * filters1 * taps * taps),
      choices_(static_cast<std::size_t>(filters1 * shape_.pooled_rows() * shape_.pooled_columns() * cell)),
      choice_row_(static_cast<long>(shape_.pooled_columns()) * cell),
      choice_plane_(choice_row_ * shape_.pooled_rows()) {
  assert(!fault_of(shape_) && weights.values.size() == weight_count(shape_));
  layout_.pack(weights.values, this->weights());
  pack_convolutions();
}

void BatchNetwork::pack_convolutions() {
  pack_convolution(at(layout_.conv1_weight()), filters1, shape_.frames, conv1_tile, conv1_weights_.data());
  pack_convolution(at(layout_.conv2_weight()), filters2, filters1, conv2_tile, conv2_weights_.data());
}

void BatchNetwork::load(const Batch& batch, Share share) {
  const LoadJob job{.frames = batch.frames.data(),
                    .mirrored = batch.mirrored.empty() ? nullptr : batch.mirrored.data(),
                    .samples = static_cast<int>(batch.frames.size()),
                    .channels = shape_.frames,
                    .rows = shape_.rows(),
                    .columns = shape_.columns(),
                    .output = input.inner()};
  const int rows = shape_.frames * shape_.rows();
  kernels_->load(job, share.first(rows), share.last(rows));
}

void BatchNetwork::convolve1(Share share) {
  const ConvolutionJob job{.input = input.with_margin(),
                           .input_channels = shape_.frames,
                           .weights = conv1_weights_.data(),
                           .bias = at(layout_.conv1_bias()),
                           .output = pooled.inner(),
                           .outputs = filters1,
                           .rows = shape_.pooled_rows(),
                           .columns = shape_.pooled_columns()};
  kernels_->convolve_and_pool(job, choices(), share.first(job.rows), share.last(job.rows));
}

void BatchNetwork::convolve2(Share share) {
  const long row = static_cast<long>(shape_.columns2()) * cell;
  const ConvolutionJob job{.input = pooled.with_margin(),
                           .input_channels = filters1,
                           .weights = conv2_weights_.data(),
                           .bias = at(layout_.conv2_bias()),
                           .output = {features.data(), row, row * shape_.rows2()},
                           .outputs = filters2,
                           .rows = shape_.rows2(),
                           .columns = shape_.columns2()};
  kernels_->convolve_relu(job, share.first(job.rows), share.last(job.rows));
}

void BatchNetwork::dense1(Share share) {
  const DenseJob job{.heads = layout_.heads(),
                     .head_rows = hidden1,
                     .head_cells = head_cells,
                     .blocks = layout_.blocks(),
                     .weights = at(layout_.dense1()),
                     .bias = {at(layout_.speed1_bias()), shape_.fusion ? at(layout_.gain1_bias()) : nullptr},
                     .input = features.data(),
                     .output = hidden_first.data()};
  const int tiles = job.heads * hidden1 / dense_tile;
  kernels_->dense(job, share.first(tiles), share.last(tiles));
}

void BatchNetwork::heads() {
  const DenseJob job{.heads = 1,
                     .head_rows = hidden2,
                     .head_cells = hidden2,
                     .blocks = head_cells / block,
                     .weights = at(layout_.dense2()),
                     .bias = {at(layout_.speed2_bias()), nullptr},
                     .input = hidden_first.data(),
                     .output = hidden_second.data()};
  kernels_->dense(job, 0, hidden2 / dense_tile);
  kernels_->readout({hidden2, at(layout_.speed3_weight()), *at(layout_.speed3_bias()), hidden_second.data(),
                     thermal.data()});
  if (!shape_.fusion) return;
  kernels_->readout({hidden1, at(layout_.gain2_weight()), *at(layout_.gain2_bias()),
                     hidden_first.data() + head_cells * cell, gain.data()});
  for (int s = 0; s < cell; ++s) gain.data()[s] = 1.0F / (1.0F + std::exp(-gain.data()[s]));
}

}  // namespace thermorig::network
