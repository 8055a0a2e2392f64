// SPDX-License-Identifier: MIT
#include "inference_network.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace thermorig::network {

namespace {

constexpr int vector = 16;  // floats of the longest one

const InferenceKernels& kernels_of(InstructionSet set) {
#ifdef THERMORIG_X86_64_KERNELS
  if (set == InstructionSet::avx512) return avx512::inference_kernels;
  if (set == InstructionSet::avx2) return avx2::inference_kernels;
#endif
  assert(set == InstructionSet::baseline);
  return baseline::inference_kernels;
}

PoolingConvolution convolution1(const Shape& shape, const InferenceWeights& weights) {
  PoolingConvolution layer{};
  layer.weights = weights.convolution1.data();
  layer.bias = weights.bias1.data();
  layer.channels = shape.frames;
  layer.input_rows = shape.rows() + 2 * shape.padding1;
  layer.input_stride = shape.columns() + 2 * shape.padding1 + row_slack;
  layer.pooled_rows = shape.pooled_rows();
  layer.pooled_columns = shape.pooled_columns();
  layer.output_stride = shape.pooled_columns() + 2 * shape.padding2;
  layer.output_plane = layer.output_stride * (shape.pooled_rows() + 2 * shape.padding2);
  return layer;
}

FeatureConvolution convolution2(const Shape& shape, const InferenceWeights& weights,
                                const PoolingConvolution& before) {
  FeatureConvolution layer{};
  layer.weights = weights.convolution2.data();
  layer.bias = weights.bias2.data();
  layer.input_plane = before.output_plane;
  layer.input_stride = before.output_stride;
  layer.rows = shape.rows2();
  layer.columns = shape.columns2();
  return layer;
}

}  // namespace

InferenceNetwork::InferenceNetwork(const Weights& weights, Precision precision, InstructionSet set)
    : shape_(weights.shape),
      kernels_(kernels_of(set)),
      weights_(weights, precision, kernels_),
      conv1_(convolution1(shape_, weights_)),
      conv2_(convolution2(shape_, weights_, conv1_)),
      padded_(at(conv1_.channels * conv1_.input_rows * conv1_.input_stride)),
      pooled_(at(filters1 * conv1_.output_plane)),
      features_(at(shape_.features())),
      places_(at(std::max(shape_.features(), hidden1) + vector)),
      hidden_(at(2 * hidden1 + vector)),
      readout_(hidden2) {}

void InferenceNetwork::load(std::span<const float> frames) {
  assert(frames.size() == shape_.inputs());
  const float* from = frames.data();
  for (int frame = 0; frame < shape_.frames; ++frame)
    for (int row = 0; row < shape_.rows(); ++row, from += shape_.columns()) {
      const int padded_row = frame * conv1_.input_rows + row + shape_.padding1;
      std::copy_n(from, shape_.columns(),
                  padded_.data() + padded_row * conv1_.input_stride + shape_.padding1);
    }
}

void InferenceNetwork::convolve1() {
  float* inside = pooled_.data() + shape_.padding2 * (conv1_.output_stride + 1);
  kernels_.convolve_and_pool(conv1_, padded_.data(), inside);
}

void InferenceNetwork::convolve2() {
  kernels_.convolve(conv2_, pooled_.data(), features_.data());
}

void InferenceNetwork::list_features() {
  listed_ = kernels_.list_nonzero(features_.data(), shape_.features(), places_.data());
}

void InferenceNetwork::dense1() {
  kernels_.dense(weights_.first.layer, features_.data(), places_.data(), listed_, hidden_.data());
}

float fusion_of(const Output& output, float gyro) {
  return output.gain * output.thermal + (1.0F - output.gain) * gyro;  // paper eq. 2
}

Output InferenceNetwork::heads(float gyro) {
  const int listed = kernels_.list_nonzero(hidden_.data(), hidden1, places_.data());
  kernels_.dense(weights_.second.layer, hidden_.data(), places_.data(), listed, readout_.data());
  Output output;
  output.thermal = weights_.readout_bias + kernels_.dot(readout_.data(), weights_.readout.data(), hidden2);
  output.fusion = output.thermal;
  if (!shape_.fusion) return output;
  constexpr int whole = (hidden1 + vector - 1) / vector * vector;
  const float logit = weights_.gain_readout_bias +
                      kernels_.dot(hidden_.data() + hidden1, weights_.gain_readout.data(), whole);
  output.gain = 1.0F / (1.0F + std::exp(-logit));
  output.fusion = fusion_of(output, gyro);
  return output;
}

int InferenceNetwork::bytes_per_feature() const {
  const DenseLayer& layer = weights_.first.layer;
  return layer.blocks * layer.width * (layer.half ? 2 : 4);
}

}  // namespace thermorig::network
