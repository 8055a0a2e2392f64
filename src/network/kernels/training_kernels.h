// SPDX-License-Identifier: MIT
#pragma once

// What a step of training asks of the kernels. Plain structs and functions: the kernels include no header of
// the standard library (see vector.h).
//
// All activations and their gradients lie in *cells* of 32 floats, the 32 samples of a batch, so that vectors
// run over samples whatever the shape of the network. (channels, rows, columns) of cells are *planes*.

namespace thermorig::network {

inline constexpr int cell = 32;        // samples, and floats, of a cell
inline constexpr int taps = 5;         // of a convolution, along rows and along columns
inline constexpr int block = 32;       // features that lie side by side in a dense layer's weights
inline constexpr int dense_tile = 10;  // rows of a dense layer that are worked on together: divides 120, 80
inline constexpr int conv1_tile = 6;   // outputs of a convolution whose weights lie side by side
inline constexpr int conv2_tile = 4;
inline constexpr int conv2_input_tile = 6;  // the same for Conv2's input gradient, which is a convolution too

/// A part of planes: where its cell (0, 0, 0) is, and how many floats away the next row and plane are.
struct Planes {
  float* first;
  long row, plane;
};

/// Windows into planes: (B) pointers to (channels, rows, columns), flipped left to right where asked.
struct LoadJob {
  const float* const* frames;
  const unsigned char* mirrored;  // null: none
  int samples;                    // B; the other lanes become 0
  int channels, rows, columns;
  Planes output;
};

/// A 5x5 convolution: output(o, y, x) = bias(o) + sum over i, ky, kx of weight(o, i, ky, kx) * input(i, y +
/// ky, x
/// + kx). `input` starts at the first tap of the first output, in the zeros around the image if it is padded.
struct ConvolutionJob {
  Planes input;
  int input_channels;
  const float* weights;  // (outputs / tile, input_channels, 5, 5, tile)
  const float* bias;     // (outputs); null: none
  Planes output;
  int outputs, rows, columns;
};

/// What max-pooling chose of its 2x2: 0..3 row by row, 4 where ReLU lets nothing through.
struct Choices {
  int* first;  // (channels, rows, columns) of cells
  long row, plane;
};

/// Sums over the outputs: weight_gradient(o, i, ky, kx) = sum over y, x and samples of gradient(o, y, x) *
/// input(i, y + ky, x + kx), bias_gradient(o) = sum of gradient(o). With max-pool behind the convolution,
/// `gradient` is that of the pooled cells.
struct ConvolutionGradientJob {
  Planes gradient;
  Choices choices;  // null: no max-pool
  Planes input;
  int outputs, input_channels;
  int rows, columns;       // of `gradient`
  float* sums;             // (outputs, input_channels, 5, 5, 16): room for a vector each
  float* weight_gradient;  // (outputs, input_channels, 5, 5)
  float* bias_gradient;    // (outputs)
};

/// Kingma & Ba 2015, algorithm 1, with the corrections of both biases in the rate and in epsilon: weight -=
/// first /
/// ((sqrt(second) + epsilon) / rate), rate = alpha * sqrt(1 - beta2^t) / (1 - beta1^t), epsilon = 1e-8 *
/// sqrt(1 - beta2^t). The divisor is 2 * sqrt(root_scale * second) + divisor_least, which spares the kernels
/// operations.
struct AdamStep {
  float root_scale;     // 1 / (2 * rate)^2
  float divisor_least;  // epsilon / rate
  float one_minus_beta1, one_minus_beta2;
};

/// Fully connected with ReLU: one or two heads of `head_rows` outputs each, which share their inputs. A
/// head's outputs start `head_cells` cells after those of the head before.
struct DenseJob {
  int heads, head_rows, head_cells;
  int blocks;            // of 32 features; features that fill up the last block are 0, as are their weights
  const float* weights;  // (blocks, heads * head_rows, 32)
  const float* bias[2];  // (head_rows) each
  const float* input;    // (blocks * 32) cells
  float* output;         // cells
};

/// Its gradients. Weights are changed in place by Adam while their gradient is still in registers; with
/// `weight_gradient` they stay as they are and the gradient is stored.
struct DenseGradientJob {
  int heads, head_rows, head_cells;
  int blocks;
  const float* gradient;  // of the outputs before ReLU: cells
  const float* input;     // (blocks * 32) cells: outputs of a ReLU
  float* weights;         // (blocks, heads * head_rows, 32), as are the moments and the gradient
  float* first_moment;
  float* second_moment;
  float* weight_gradient;  // null: change the weights
  AdamStep adam;
  float* input_gradient;  // of the inputs before their ReLU
  const int* place_of;    // (blocks * 32): where in input_gradient each feature's cell is, in floats
};

/// One output from the `count` cells of a hidden layer, for each sample: output = bias + sum of weights(i) *
/// input(i).
struct ReadoutJob {
  int count;
  const float* weights;  // (count)
  float bias;
  const float* input;  // (count) cells: outputs of a ReLU
  float* output;       // a cell
};

struct ReadoutGradientJob {
  int count;
  const float* weights;
  const float* input;
  const float* gradient;   // of the output: a cell
  float* weight_gradient;  // (count)
  float* bias_gradient;    // (1)
  float* input_gradient;   // (count) cells, of the inputs before their ReLU
};

/// The kernels of one instruction set. Ranges are [first, last); parts of a range may be done at the same
/// time.
struct TrainingKernels {
  void (*load)(const LoadJob&, int first_row, int last_row);  // rows of all channels, counted through
  // Conv1, ReLU, max-pool; output: planes of pooled cells
  void (*convolve_and_pool)(const ConvolutionJob&, const Choices&, int first_row, int last_row);
  void (*convolve_relu)(const ConvolutionJob&, int first_row, int last_row);  // Conv2, ReLU
  void (*convolve)(const ConvolutionJob&, int first_row, int last_row);       // Conv2's input gradient
  // Units are input channel * 5 + row of taps; whoever has unit 0 has the biases.
  void (*conv1_gradient)(const ConvolutionGradientJob&, int first_unit, int last_unit);
  void (*conv2_gradient)(const ConvolutionGradientJob&, int first_unit, int last_unit);
  void (*dense)(const DenseJob&, int first_tile, int last_tile);  // tiles of dense_tile rows
  void (*dense_gradient)(const DenseGradientJob&, int first_block, int last_block);
  // Sum over the samples of each row's cell
  void (*sum_cells)(const float* cells, int count, float* sums);
  void (*readout)(const ReadoutJob&);
  void (*readout_gradient)(const ReadoutGradientJob&);
  // count is a multiple of 16
  void (*adam)(const AdamStep&, int count, const float* gradient, float* weights, float* first_moment,
               float* second_moment);
};

namespace baseline {
extern const TrainingKernels training_kernels;
}
namespace avx2 {
extern const TrainingKernels training_kernels;
}
namespace avx512 {
extern const TrainingKernels training_kernels;
}

}  // namespace thermorig::network
