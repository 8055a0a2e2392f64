// SPDX-License-Identifier: MIT
#include "inference_convolution.h"

#include "inference_vector.h"

namespace thermorig::network::THERMORIG_KERNELS {

namespace {

constexpr int taps = 5;       // along rows and along columns
constexpr int filters1 = 6;   // of Conv1
constexpr int filters2 = 16;  // of Conv2

Vector larger(Vector a, Vector b) {
  return a > b ? a : b;
}

// --- Conv1
// ---------------------------------------------------------------------------------------------------

/// Two rows of `vectors` vectors of all six filters stay in registers: 24 accumulators where there are 32
/// registers, 12 where there are 16.
#if defined(__AVX512F__) || defined(__aarch64__)
constexpr int widest_tile = 2;
#else
constexpr int widest_tile = 1;
#endif

/// The larger of two rows after ReLU, for one tile; `peaks`: (6, row_slack).
template <int vectors>
void convolve_tile(const PoolingConvolution& layer, const float* input, float* peaks) {
  Vector sum[filters1][2][vectors];
  THERMORIG_UNROLL
  for (int f = 0; f < filters1; ++f) {
    THERMORIG_UNROLL
    for (int v = 0; v < vectors; ++v) sum[f][0][v] = sum[f][1][v] = broadcast(layer.bias[f]);
  }
  const float* w = layer.weights;
  for (int c = 0; c < layer.channels; ++c) {
    for (int i = 0; i < taps; ++i) {
      const float* row = input + (c * layer.input_rows + i) * layer.input_stride;
      THERMORIG_UNROLL
      for (int j = 0; j < taps; ++j, w += filters1) {
        THERMORIG_UNROLL
        for (int f = 0; f < filters1; ++f) {
          THERMORIG_UNROLL
          for (int v = 0; v < vectors; ++v) {
            sum[f][0][v] += w[f] * load(row + j + v * lanes);
            sum[f][1][v] += w[f] * load(row + layer.input_stride + j + v * lanes);
          }
        }
      }
    }
  }
  THERMORIG_UNROLL
  for (int f = 0; f < filters1; ++f) {
    THERMORIG_UNROLL
    for (int v = 0; v < vectors; ++v)
      store(peaks + f * row_slack + v * lanes, larger(larger(sum[f][0][v], sum[f][1][v]), Vector{}));
  }
}

/// The larger of neighbours: the last part of the pooling.
void pool_tile(const PoolingConvolution& layer, const float* peaks, int columns, float* output) {
  for (int f = 0; f < filters1; ++f) {
    const float* from = peaks + f * row_slack;
    float* to = output + f * layer.output_plane;
    for (int x = 0; x < columns; ++x) to[x] = from[2 * x] > from[2 * x + 1] ? from[2 * x] : from[2 * x + 1];
  }
}

template <int vectors>
void convolve_and_pool_tiles(const PoolingConvolution& layer, const float* input, float* output) {
  constexpr int tile = vectors * lanes;
  alignas(64) float peaks[filters1 * row_slack];
  for (int y = 0; y < layer.pooled_rows; ++y)
    for (int x = 0; x < layer.pooled_columns; x += tile / 2) {
      convolve_tile<vectors>(layer, input + 2 * y * layer.input_stride + 2 * x, peaks);
      const int left = layer.pooled_columns - x;
      pool_tile(layer, peaks, left < tile / 2 ? left : tile / 2, output + y * layer.output_stride + x);
    }
}

// --- Conv2
// ---------------------------------------------------------------------------------------------------

constexpr int parts = filters2 / lanes;  // vectors that the 16 outputs of a pixel are

/// Pixels side by side whose outputs stay in registers.
#if defined(__AVX512F__)
constexpr int wide_tile = 16, tile = 8, narrow_tile = 4;
#elif defined(__AVX2__) || defined(__aarch64__)
constexpr int wide_tile = 4, tile = 4, narrow_tile = 2;
#else
constexpr int wide_tile = 2, tile = 2, narrow_tile = 2;
#endif

template <int pixels>
void convolve_pixels(const FeatureConvolution& layer, const float* input, float* output) {
  Vector sum[pixels][parts];
  THERMORIG_UNROLL
  for (int p = 0; p < pixels; ++p) {
    THERMORIG_UNROLL
    for (int v = 0; v < parts; ++v) sum[p][v] = load(layer.bias + v * lanes);
  }
  const float* w = layer.weights;
  for (int c = 0; c < filters1; ++c) {
    for (int i = 0; i < taps; ++i, w += taps * filters2) {
      const float* row = input + c * layer.input_plane + i * layer.input_stride;
      // By input pixel: each is broadcast once for all its taps.
      THERMORIG_UNROLL
      for (int x = 0; x < pixels + taps - 1; ++x) {
        const Vector value = broadcast(row[x]);
        THERMORIG_UNROLL
        for (int j = 0; j < taps; ++j) {
          if (x - j < 0 || x - j >= pixels) continue;
          THERMORIG_UNROLL
          for (int v = 0; v < parts; ++v) sum[x - j][v] += value * load(w + j * filters2 + v * lanes);
        }
      }
    }
  }
  THERMORIG_UNROLL
  for (int p = 0; p < pixels; ++p) {
    THERMORIG_UNROLL
    for (int v = 0; v < parts; ++v) store(output + p * filters2 + v * lanes, larger(sum[p][v], Vector{}));
  }
}

/// A row in tiles; the last one starts early enough to be whole.
template <int pixels>
void convolve_row(const FeatureConvolution& layer, const float* input, float* output) {
  for (int x = 0; x < layer.columns; x += pixels) {
    const int start = x + pixels <= layer.columns ? x : layer.columns - pixels;
    convolve_pixels<pixels>(layer, input + start, output + start * filters2);
  }
}

using RowKernel = void (*)(const FeatureConvolution&, const float*, float*);

RowKernel row_kernel(int columns) {
  if (columns >= wide_tile) return convolve_row<wide_tile>;
  if (columns >= tile) return convolve_row<tile>;
  if (columns >= narrow_tile) return convolve_row<narrow_tile>;
  return convolve_row<1>;
}

}  // namespace

void convolve_and_pool(const PoolingConvolution& layer, const float* input, float* output) {
  if (widest_tile > 1 && 2 * layer.pooled_columns > lanes)
    convolve_and_pool_tiles<widest_tile>(layer, input, output);
  else
    convolve_and_pool_tiles<1>(layer, input, output);
}

void convolve(const FeatureConvolution& layer, const float* input, float* output) {
  const RowKernel row = row_kernel(layer.columns);
  for (int y = 0; y < layer.rows; ++y)
    row(layer, input + y * layer.input_stride, output + y * layer.columns * filters2);
}

}  // namespace thermorig::network::THERMORIG_KERNELS
