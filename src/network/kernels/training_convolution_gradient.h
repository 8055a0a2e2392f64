// SPDX-License-Identifier: MIT
#pragma once

#include "training_convolution.h"

// The gradients of a convolution's weights and biases.

namespace thermorig::network::THERMORIG_KERNELS {

/// A band of the outputs' gradient that stays in the first cache while all of the weights use it: vectors of
/// the same samples row by row, close together. Its rows run through (vector of samples, row).
template <int outputs>
struct GradientBand {
  static constexpr int room = 24 * 1024 / THERMORIG_VECTOR_BYTES / outputs;
  alignas(64) float gradient[outputs][room * lanes];
  int first, last;  // rows
};

template <int count>
struct Count {
  static constexpr int value = count;
};

/// Where the sums of weight (output, channel, ky, 0) are.
static inline float* sums_of(const ConvolutionGradientJob& job, int output, int unit) {
  return job.sums + (static_cast<long>(output) * job.input_channels * taps + unit) * taps * lanes;
}

/// Adds a cell of the gradient. `in` are the inputs of the column before where there are registers for them.
template <int outputs>
static inline void add_column(Vector (&sums)[outputs][taps], [[maybe_unused]] Vector (&in)[taps],
                              const float* gradient, const float* input) {
  constexpr int next_output = GradientBand<outputs>::room * lanes;
  if constexpr (accumulators == 24) {
    THERMORIG_UNROLL
    for (int kx = 1; kx < taps; ++kx) in[kx - 1] = in[kx];
    in[taps - 1] = load(input + (taps - 1) * cell);
    THERMORIG_UNROLL
    for (int o = 0; o < outputs; ++o) {
      const Vector of = load(gradient + o * next_output);
      THERMORIG_UNROLL
      for (int kx = 0; kx < taps; ++kx) sums[o][kx] += of * in[kx];
    }
  } else {
    Vector of[outputs];
    THERMORIG_UNROLL
    for (int o = 0; o < outputs; ++o) of[o] = load(gradient + o * next_output);
    asm("" : "+r"(input));  // hides that the column before had most of these already
    THERMORIG_UNROLL
    for (int kx = 0; kx < taps; ++kx) {
      const Vector tap = load(input + kx * cell);
      THERMORIG_UNROLL
      for (int o = 0; o < outputs; ++o) sums[o][kx] += of[o] * tap;
    }
  }
}

/// Adds a band to the sums of `outputs` x 5 weights. A unit is an input channel and a row of taps.
template <int outputs>
THERMORIG_TILE static void add_band(const ConvolutionGradientJob& job, const GradientBand<outputs>& band,
                                    int output, int unit, int rows, int columns) {
  float* const place = sums_of(job, output, unit);
  const long next_output = static_cast<long>(job.input_channels) * taps * taps * lanes;
  const float* const top = at(job.input, unit / taps, unit % taps, 0);
  const long next_row = job.input.row;
  Vector sums[outputs][taps];
  load_tile(sums, place, next_output, lanes);

  const float* gradient = band.gradient[0];
  int y = band.first % rows, v = band.first / rows * lanes;
  for (int row = band.first; row < band.last; ++row) {
    const float* input = top + y * next_row + v;
    Vector in[taps];  // of one column; the next column's are the same but for one
    THERMORIG_UNROLL
    for (int kx = 1; kx < taps; ++kx) in[kx] = load(input + (kx - 1) * cell);
    const auto add_columns = [&](auto count) {
      THERMORIG_UNROLL
      for (int x = 0; x < count.value; ++x)
        add_column<outputs>(sums, in, gradient + x * lanes, input + x * cell);
      gradient += count.value * lanes;
      input += count.value * cell;
    };
    // Loops of a few turns: processors foresee their ends.
    int x = 0;
    THERMORIG_KEEP_LOOP
    for (; x + 8 <= columns; x += 8) add_columns(Count<8>());
    THERMORIG_KEEP_LOOP
    for (; x < columns; ++x) add_columns(Count<1>());
    if (++y == rows) {
      y = 0;
      v += lanes;
    }
  }
  store_tile(sums, place, next_output, lanes);
}

/// The gradient of output channels as it is; adds it to the sums of the biases.
template <int outputs>
static inline void copy_band(const ConvolutionGradientJob& job, int output, GradientBand<outputs>& band,
                             Vector (&biases)[outputs]) {
  for (int o = 0; o < outputs; ++o) {
    float* to = band.gradient[o];
    for (int row = band.first; row < band.last; ++row) {
      const float* from = at(job.gradient, output + o, row % job.rows, 0) + row / job.rows * lanes;
      for (int x = 0; x < job.columns; ++x, from += cell, to += lanes) {
        const Vector gradient = load(from);
        store(to, gradient);
        biases[o] += gradient;
      }
    }
  }
}

/// Through max-pool and ReLU: the gradient of a pooled cell goes to the one of the four that was chosen. The
/// band gets twice the rows and columns.
template <int outputs>
static inline void unpool_band(const ConvolutionGradientJob& job, int output, GradientBand<outputs>& band,
                               Vector (&biases)[outputs]) {
  const int wide = 2 * job.columns * lanes;
  for (int o = 0; o < outputs; ++o) {
    float* to = band.gradient[o];
    for (int row = band.first / 2; row < band.last / 2; ++row, to += wide) {
      const int y = row % job.rows, v = row / job.rows * lanes;
      const float* from = at(job.gradient, output + o, y, 0) + v;
      const int* choices = job.choices.first + (output + o) * job.choices.plane + y * job.choices.row + v;
      for (int x = 0; x < job.columns; ++x, from += cell, choices += cell, to += 2 * lanes) {
        const Vector gradient = load(from);
        const Mask choice = *reinterpret_cast<const Mask*>(choices);
        biases[o] += choice < 4 ? gradient : Vector{};
        THERMORIG_UNROLL
        for (int i = 0; i < 4; ++i)
          store(to + i / 2 * wide + i % 2 * lanes, choice == i ? gradient : Vector{});
      }
    }
  }
}

/// Each sum takes the bands in the same order, however the units are shared out. `scale`: 2 through max-pool,
/// or 1.
template <int outputs, int scale>
static inline void weight_gradient(const ConvolutionGradientJob& job, int first_unit, int last_unit) {
  const int rows = scale * job.rows, columns = scale * job.columns;
  const int most = GradientBand<outputs>::room / (scale * columns);
  const int parts = (job.rows * vectors + most - 1) / most;
  GradientBand<outputs> band;
  for (int output = 0; output < job.outputs; output += outputs) {
    Vector biases[outputs] = {};
    for (int o = output; o < output + outputs; ++o)
      for (int i = first_unit; i < last_unit; ++i) THERMORIG_UNROLL
    for (int kx = 0; kx < taps; ++kx) store(sums_of(job, o, i) + kx * lanes, Vector{});
    for (int part = 0; part < parts; ++part) {
      band.first = part * job.rows * vectors / parts * scale;
      band.last = (part + 1) * job.rows * vectors / parts * scale;
      if constexpr (scale == 2)
        unpool_band(job, output, band, biases);
      else
        copy_band(job, output, band, biases);
      for (int unit = first_unit; unit < last_unit; ++unit) add_band(job, band, output, unit, rows, columns);
    }
    for (int o = output; o < output + outputs; ++o)
      for (int i = first_unit; i < last_unit; ++i) THERMORIG_UNROLL
    for (int kx = 0; kx < taps; ++kx)
      job.weight_gradient[(o * job.input_channels * taps + i) * taps + kx] =
          sum_of(load(sums_of(job, o, i) + kx * lanes));
    if (first_unit == 0) THERMORIG_UNROLL
    for (int o = 0; o < outputs; ++o) job.bias_gradient[output + o] = sum_of(biases[o]);
  }
}

}  // namespace thermorig::network::THERMORIG_KERNELS
