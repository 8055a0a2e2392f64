// SPDX-License-Identifier: MIT
#pragma once

#include "training_vector.h"

// A convolution: forward, and the gradient of its inputs.

namespace thermorig::network::THERMORIG_KERNELS {

static inline float* at(const Planes& planes, int channel, int row, int column) {
  return planes.first + channel * planes.plane + row * planes.row + static_cast<long>(column) * cell;
}

/// `outputs` x `wide` cells of a row, one vector of samples each, in registers throughout.
template <int outputs, int wide>
static inline void convolve_tile(const ConvolutionJob& job, int tile, int y, int x, int v,
                                 Vector (&sums)[outputs][wide]) {
  THERMORIG_UNROLL
  for (int o = 0; o < outputs; ++o) THERMORIG_UNROLL
  for (int i = 0; i < wide; ++i) sums[o][i] = job.bias ? splat(job.bias[tile * outputs + o]) : Vector{};
  const float* weights = job.weights + static_cast<long>(tile) * job.input_channels * taps * taps * outputs;
  for (int channel = 0; channel < job.input_channels; ++channel) {
    for (int ky = 0; ky < taps; ++ky) {
      const float* row = at(job.input, channel, y + ky, x) + v;
      Vector in[wide];  // of one tap; the next tap's are the same but for one
      THERMORIG_UNROLL
      for (int i = 1; i < wide; ++i) in[i] = load(row + (i - 1) * cell);
      row += (wide - 1) * cell;
      THERMORIG_KEEP_LOOP
      for (int kx = 0; kx < taps; ++kx, row += cell, weights += outputs) {
        THERMORIG_UNROLL
        for (int i = 1; i < wide; ++i) in[i - 1] = in[i];
        in[wide - 1] = load(row);
        THERMORIG_UNROLL
        for (int o = 0; o < outputs; ++o) {
          const Vector weight = splat(weights[o]);
          THERMORIG_UNROLL
          for (int i = 0; i < wide; ++i) sums[o][i] += weight * in[i];
        }
      }
    }
  }
}

template <int outputs, int wide, class Finish>
static inline void convolve_columns(const ConvolutionJob& job, int tile, int y, int x, int v, Finish finish) {
  Vector sums[outputs][wide];
  const Planes out = job.output;  // a copy: it could change with each store, for all the compiler knows
  convolve_tile<outputs, wide>(job, tile, y, x, v, sums);
  THERMORIG_UNROLL
  for (int o = 0; o < outputs; ++o) THERMORIG_UNROLL
  for (int i = 0; i < wide; ++i) finish(at(out, tile * outputs + o, y, x + i) + v, sums[o][i]);
}

/// `columns` <= `wide`: the tile that is just as wide.
template <int outputs, int wide, class Finish>
static inline void convolve_some(const ConvolutionJob& job, int tile, int y, int x, int columns, int v,
                                 Finish finish) {
  if (columns == wide) return convolve_columns<outputs, wide>(job, tile, y, x, v, finish);
  if constexpr (wide > 1) convolve_some<outputs, wide - 1>(job, tile, y, x, columns, v, finish);
}

/// Rows of the output in tiles of about equal width. `finish(where, value)` stores a vector.
template <int outputs, class Finish>
static inline void convolve_rows(const ConvolutionJob& job, int first_row, int last_row, Finish finish) {
  constexpr int most = accumulators / outputs;
  const int parts = (job.columns + most - 1) / most;
  for (int y = first_row; y < last_row; ++y) {
    for (int v = 0; v < cell; v += lanes) {
      for (int part = 0; part < parts; ++part) {
        const int x = part * job.columns / parts;
        const int columns = (part + 1) * job.columns / parts - x;
        for (int tile = 0; tile < job.outputs / outputs; ++tile)
          convolve_some<outputs, most>(job, tile, y, x, columns, v, finish);
      }
    }
  }
}

}  // namespace thermorig::network::THERMORIG_KERNELS
