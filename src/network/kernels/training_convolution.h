// SPDX-License-Identifier: MIT
#pragma once

#include "training_vector.h"

// The two loops that both convolutions are made of, forward and backward.

namespace thermorig::network::THERMORIG_KERNELS {

static inline float* at(const Planes& planes, int channel, int row, int column) {
  return planes.first + channel * planes.plane + row * planes.row + static_cast<long>(column) * cell;
}

/// `outputs` x `wide` cells of a row, one vector of samples each, in registers throughout.
template <int outputs, int wide>
static inline void convolve_tile(const ConvolutionJob& job, int tile, int y, int x, int v,
                                 Vector (&sums)[outputs][wide]) {
  for (int o = 0; o < outputs; ++o)
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
  convolve_tile<outputs, wide>(job, tile, y, x, v, sums);
  for (int o = 0; o < outputs; ++o)
    for (int i = 0; i < wide; ++i) finish(at(job.output, tile * outputs + o, y, x + i) + v, sums[o][i]);
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

/// Where the sums of weight (output, channel, ky, 0) are.
static inline float* sums_of(const ConvolutionGradientJob& job, int output, int channel, int ky) {
  return job.sums + ((static_cast<long>(output) * job.input_channels + channel) * taps + ky) * taps * lanes;
}

/// Adds the rows [top, bottom) to the sums of `outputs` x 5 weights (one input channel, one row of taps).
template <int outputs>
THERMORIG_TILE void gradient_tile(const ConvolutionGradientJob& job, int output, int channel, int ky, int top,
                                  int bottom) {
  Vector sums[outputs][taps];
  for (int o = 0; o < outputs; ++o)
    for (int kx = 0; kx < taps; ++kx) sums[o][kx] = load(sums_of(job, output + o, channel, ky) + kx * lanes);
  for (int y = top; y < bottom; ++y) {
    for (int v = 0; v < cell; v += lanes) {
      const float* gradient = at(job.gradient, output, y, 0) + v;
      const float* input = at(job.input, channel, y + ky, 0) + v;
      Vector in[taps];  // of one column; the next column's are the same but for one, which takes its place
      THERMORIG_UNROLL
      for (int kx = 0; kx < taps - 1; ++kx) in[kx] = load(input + kx * cell);
      THERMORIG_KEEP_LOOP
      for (int x = 0; x < job.columns; x += taps, gradient += taps * cell, input += taps * cell) {
        THERMORIG_UNROLL
        for (int i = 0; i < taps; ++i) {
          if (i > 0 && x + i >= job.columns) break;
          in[(i + taps - 1) % taps] = load(input + (i + taps - 1) * cell);
          THERMORIG_UNROLL
          for (int o = 0; o < outputs; ++o) {
            const Vector of = load(gradient + i * cell + o * job.gradient.plane);
            THERMORIG_UNROLL
            for (int kx = 0; kx < taps; ++kx) sums[o][kx] += of * in[(i + kx) % taps];
          }
        }
      }
    }
  }
  for (int o = 0; o < outputs; ++o)
    for (int kx = 0; kx < taps; ++kx) store(sums_of(job, output + o, channel, ky) + kx * lanes, sums[o][kx]);
}

/// The gradients of `outputs` x 5 weights from their sums.
template <int outputs>
static inline void finish_sums(const ConvolutionGradientJob& job, int output, int channel, int ky) {
  for (int o = output; o < output + outputs; ++o) {
    const float* const sums = sums_of(job, o, channel, ky);
    for (int kx = 0; kx < taps; ++kx)
      job.weight_gradient[(sums - job.sums) / lanes + kx] = sum_of(load(sums + kx * lanes));
  }
}

/// Units of input channel * 5 + row of taps. The rows go by in bands that stay in the first cache while all rows
/// of taps use them; each sum takes them in the same order however the units are shared out.
template <int outputs>
static inline void weight_gradient(const ConvolutionGradientJob& job, int first_unit, int last_unit) {
  constexpr int band_bytes = 16 * 1024;
  const int row_bytes = outputs * job.columns * cell * static_cast<int>(sizeof(float));
  const int band = band_bytes / row_bytes > 1 ? band_bytes / row_bytes : 1;
  for (int output = 0; output < job.outputs; output += outputs) {
    for (int channel = first_unit / taps; channel * taps < last_unit; ++channel) {
      const int first = channel * taps > first_unit ? 0 : first_unit % taps;
      const int last = (channel + 1) * taps < last_unit ? taps : last_unit - channel * taps;
      for (int ky = first; ky < last; ++ky)
        for (int o = output; o < output + outputs; ++o)
          for (int kx = 0; kx < taps; ++kx) store(sums_of(job, o, channel, ky) + kx * lanes, Vector{});
      for (int top = 0; top < job.rows; top += band)
        for (int ky = first; ky < last; ++ky)
          gradient_tile<outputs>(job, output, channel, ky, top,
                                 top + band < job.rows ? top + band : job.rows);
      for (int ky = first; ky < last; ++ky) finish_sums<outputs>(job, output, channel, ky);
    }
  }
}

}  // namespace thermorig::network::THERMORIG_KERNELS
