// SPDX-License-Identifier: MIT
#pragma once

#include <stdint.h>

// What the inference of one window asks of the kernels. Plain structs and functions: the kernels include no
// header of the standard library (see vector.h). "Padded" rows have zeros around the image and may be longer
// than that.

namespace thermorig::network {

/// Floats of the rows that Conv1 reads and writes beyond their width, at most: a tile of 32 and 4 taps.
inline constexpr int row_slack = 36;

/// Conv1, ReLU and max-pool 2x2 in one go, vectors along the row.
struct PoolingConvolution {
  const float* weights;  // (channels, 5, 5, 6)
  const float* bias;     // (6)
  int channels;
  int input_rows, input_stride;     // padded; stride >= columns + row_slack
  int pooled_rows, pooled_columns;  // of the output, without its padding
  int output_plane, output_stride;  // floats from channel to channel and from row to row
};

/// Conv2 and ReLU, vectors along the 16 outputs.
struct FeatureConvolution {
  const float* weights;           // (6, 5, 5, 16)
  const float* bias;              // (16)
  int input_plane, input_stride;  // padded
  int rows, columns;              // of the output, which is (rows, columns, 16)
};

/// A fully connected layer with ReLU. Its outputs are cut into blocks of `width` = dense_width(outputs) that
/// a kernel keeps in registers while it walks over the inputs.
struct DenseLayer {
  const void* weights;  // (blocks, inputs, width) floats or halves
  const float* bias;    // (blocks * width)
  bool half;
  int inputs, blocks, width;
};

/// The kernels of one instruction set. Arrays that they write start at a multiple of 64 bytes.
struct InferenceKernels {
  /// `input`: (channels, input_rows, input_stride); `output`: its first value inside the padding.
  void (*convolve_and_pool)(const PoolingConvolution&, const float* input, float* output);
  /// `input`: (6, rows + 4, input_stride)
  void (*convolve)(const FeatureConvolution&, const float* input, float* output);
  /// Places of the values that are not zero, ascending; returns how many. `count` is a multiple of 16;
  /// `places` has room for 16 more.
  int (*list_nonzero)(const float* values, int count, uint16_t* places);
  int (*dense_width)(int outputs);
  /// output = the larger of 0 and weights * input + bias, over the `count` listed inputs.
  void (*dense)(const DenseLayer&, const float* input, const uint16_t* places, int count, float* output);
  /// Sum of products; `count` is a multiple of 16.
  float (*dot)(const float* a, const float* b, int count);
  /// IEEE 754 half precision, to nearest even; what is too large becomes the largest half. `count` is a
  /// multiple of 16.
  void (*to_half)(const float* values, int count, uint16_t* halves);
};

namespace baseline {
extern const InferenceKernels inference_kernels;
}
namespace avx2 {
extern const InferenceKernels inference_kernels;
}
namespace avx512 {
extern const InferenceKernels inference_kernels;
}

}  // namespace thermorig::network
