// SPDX-License-Identifier: MIT
#include "thermorig/network/estimator.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "inference_weights.h"

namespace thermorig::network {

namespace {

std::size_t at(int index) {
  return static_cast<std::size_t>(index);
}

const InferenceKernels& kernels_of(InstructionSet set) {
#ifdef THERMORIG_X86_64_KERNELS
  if (set == InstructionSet::avx512) return avx512::inference_kernels;
  if (set == InstructionSet::avx2) return avx2::inference_kernels;
#endif
  assert(set == InstructionSet::baseline);
  return baseline::inference_kernels;
}

/// Rows that hold `columns` values and their padding, and what the kernel's last vectors reach over.
int stride_of(int columns, int padding) {
  return columns + 2 * padding + row_slack;
}

PoolingConvolution convolution1(const Shape& shape, const InferenceWeights& weights) {
  PoolingConvolution layer{};
  layer.weights = weights.convolution1.data();
  layer.bias = weights.bias1.data();
  layer.channels = shape.frames;
  layer.input_rows = shape.rows() + 2 * shape.padding1;
  layer.input_stride = stride_of(shape.columns(), shape.padding1);
  layer.pooled_rows = shape.pooled_rows();
  layer.pooled_columns = shape.pooled_columns();
  layer.output_stride = shape.pooled_columns() + 2 * shape.padding2;
  layer.output_plane = layer.output_stride * (shape.pooled_rows() + 2 * shape.padding2);
  return layer;
}

FeatureConvolution convolution2(const Shape& shape, const InferenceWeights& weights) {
  const PoolingConvolution before = convolution1(shape, weights);
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

struct Estimator::Parts {
  Shape shape;
  const InferenceKernels& kernels;
  InferenceWeights weights;
  PoolingConvolution conv1;
  FeatureConvolution conv2;
  AlignedFloats padded;                // (Nf, H + 2 padding1, stride): the window amid zeros
  AlignedFloats pooled;                // (6, pooled_rows + 2 padding2, pooled_columns + 2 padding2)
  AlignedFloats features;              // (rows2, columns2, 16)
  AlignedArray<std::uint16_t> places;  // of the features that are not zero, then of the hidden values
  AlignedFloats hidden, readout;       // (240 or 120), (80), and zeros to a whole vector

  Parts(const Weights& from, Precision precision, InstructionSet set)
      : shape(from.shape),
        kernels(kernels_of(set)),
        weights(from, precision, kernels),
        conv1(convolution1(shape, weights)),
        conv2(convolution2(shape, weights)),
        padded(at(conv1.channels * conv1.input_rows * conv1.input_stride + row_slack)),
        pooled(at(filters1 * conv1.output_plane)),
        features(at(shape.features())),
        places(at(std::max(shape.features(), hidden1) + 16)),
        hidden(at(2 * hidden1 + 16)),
        readout(hidden2) {}

  void pad(std::span<const float> frames) {
    const float* from = frames.data();
    for (int frame = 0; frame < shape.frames; ++frame)
      for (int row = 0; row < shape.rows(); ++row, from += shape.columns()) {
        const int padded_row = frame * conv1.input_rows + row + shape.padding1;
        std::copy_n(from, shape.columns(), padded.data() + padded_row * conv1.input_stride + shape.padding1);
      }
  }

  void connect(const InferenceDense& dense, const AlignedFloats& input, AlignedFloats& output) {
    const int count = kernels.list_nonzero(input.data(), dense.layer.inputs, places.data());
    kernels.dense(dense.layer, input.data(), places.data(), count, output.data());
  }
};

Estimator::Estimator(const Weights& weights, Precision precision, InstructionSet set)
    : parts_(std::make_unique<Parts>(weights, precision, set)) {}

Estimator::~Estimator() = default;
Estimator::Estimator(Estimator&&) noexcept = default;
Estimator& Estimator::operator=(Estimator&&) noexcept = default;

const Shape& Estimator::shape() const {
  return parts_->shape;
}

Output Estimator::estimate(std::span<const float> frames, float gyro) {
  Parts& p = *parts_;
  assert(frames.size() == p.shape.inputs());
  p.pad(frames);
  p.kernels.convolve_and_pool(p.conv1, p.padded.data(),
                              p.pooled.data() + at(p.shape.padding2 * (p.conv1.output_stride + 1)));
  p.kernels.convolve(p.conv2, p.pooled.data(), p.features.data());
  p.connect(p.weights.first, p.features, p.hidden);
  p.connect(p.weights.second, p.hidden, p.readout);
  Output output;
  output.thermal =
      p.kernels.dot(p.readout.data(), p.weights.readout.data(), hidden2) + p.weights.readout_bias;
  output.fusion = output.thermal;
  if (!p.shape.fusion) return output;
  const float gain =
      p.kernels.dot(p.hidden.data() + hidden1, p.weights.gain_readout.data(), (hidden1 + 15) / 16 * 16);
  output.gain = 1.0F / (1.0F + std::exp(-(gain + p.weights.gain_readout_bias)));
  output.fusion = output.gain * output.thermal + (1.0F - output.gain) * gyro;  // paper eq. 2
  return output;
}

}  // namespace thermorig::network
