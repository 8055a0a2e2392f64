// SPDX-License-Identifier: MIT
#include "inference_weights.h"

#include <algorithm>

namespace thermorig::network {

namespace {

/// (filters, rest) to (rest, filters).
AlignedFloats filters_last(std::span<const float> weight, std::size_t filters) {
  const std::size_t rest = weight.size() / filters;
  AlignedFloats packed(weight.size());
  for (std::size_t f = 0; f < filters; ++f)
    for (std::size_t i = 0; i < rest; ++i) packed.data()[i * filters + f] = weight[f * rest + i];
  return packed;
}

AlignedFloats filled_up_weights(std::span<const float> values) {
  AlignedFloats copy((values.size() + 15) / 16 * 16);
  std::copy(values.begin(), values.end(), copy.data());
  return copy;
}

int first_outputs(const Shape& shape) {
  return shape.fusion ? 2 * hidden1 : hidden1;
}

}  // namespace

InferenceDense::InferenceDense(int inputs, int outputs, const InferenceKernels& kernels) : layer{} {
  layer.inputs = inputs;
  layer.width = kernels.dense_width(outputs);
  layer.blocks = (outputs + layer.width - 1) / layer.width;
  weights = AlignedFloats(at(layer.blocks * inputs * layer.width));
  bias = AlignedFloats(at(layer.blocks * layer.width));
  layer.weights = weights.data();
  layer.bias = bias.data();
}

// Three megabytes are turned around here whenever a model is loaded, hence in patches of a cache line of
// pixels by `together` outputs. That divides every width, so that a patch lies in one block; more rows of
// 3072 floats would fall on the same lines of the first cache.
void InferenceDense::take(std::span<const float> weight, std::span<const float> biases, int first,
                          int channels) {
  constexpr int together = 8, line = 16;
  const int outputs = static_cast<int>(biases.size());
  const int pixels = layer.inputs / channels;
  std::copy(biases.begin(), biases.end(), bias.data() + first);
  for (int pixel = 0; pixel < pixels; pixel += line)
    for (int channel = 0; channel < channels; ++channel)
      for (int output = 0; output < outputs; output += together) {
        const float* from = &weight[at(output * layer.inputs + channel * pixels + pixel)];
        const int part = (first + output) / layer.width, column = (first + output) % layer.width;
        const int input = part * layer.inputs + pixel * channels + channel;
        float* to = weights.data() + input * layer.width + column;
        for (int p = 0; p < std::min(line, pixels - pixel); ++p)
          for (int o = 0; o < together; ++o) to[p * channels * layer.width + o] = from[o * layer.inputs + p];
      }
}

void InferenceDense::halve(const InferenceKernels& kernels) {
  const int size = layer.blocks * layer.inputs * layer.width;
  halves = AlignedArray<std::uint16_t>(at(size));
  kernels.to_half(weights.data(), size, halves.data());
  weights = {};
  layer.weights = halves.data();
  layer.half = true;
}

InferenceWeights::InferenceWeights(const Weights& weights, Precision precision,
                                   const InferenceKernels& kernels)
    : convolution1(filters_last(weights.tensor("conv1.weight"), filters1)),
      bias1(filled_up_weights(weights.tensor("conv1.bias"))),
      convolution2(filters_last(weights.tensor("conv2.weight"), filters2)),
      bias2(filled_up_weights(weights.tensor("conv2.bias"))),
      first(weights.shape.features(), first_outputs(weights.shape), kernels),
      second(hidden1, hidden2, kernels),
      readout(filled_up_weights(weights.tensor("speed3.weight"))),
      readout_bias(weights.tensor("speed3.bias")[0]) {
  first.take(weights.tensor("speed1.weight"), weights.tensor("speed1.bias"), 0, filters2);
  second.take(weights.tensor("speed2.weight"), weights.tensor("speed2.bias"), 0, hidden1);
  if (weights.shape.fusion) {
    first.take(weights.tensor("gain1.weight"), weights.tensor("gain1.bias"), hidden1, filters2);
    gain_readout = filled_up_weights(weights.tensor("gain2.weight"));
    gain_readout_bias = weights.tensor("gain2.bias")[0];
  }
  if (precision == Precision::fp16_weights) first.halve(kernels);
}

}  // namespace thermorig::network
