// SPDX-License-Identifier: MIT
// Both convolutions, forward and backward (paper section III, Fig. 2). Planes of cells, see
// training_kernels.h.
#include "training_convolution_gradient.h"
#include "training_functions.h"

namespace thermorig::network::THERMORIG_KERNELS {

namespace {

// ---- Conv1, ReLU, max-pool ----

/// The two rows of `cells` pooled cells from column `x` on: best value and which of the four it was.
template <int cells>
void pool(const ConvolutionJob& job, const Choices& choices, int tile, int y, int x, int v) {
  constexpr int wide = 2 * cells;
  Vector upper[conv1_tile][wide], lower[conv1_tile][wide];
  convolve_tile<conv1_tile, wide>(job, tile, 2 * y, 2 * x, v, upper);
  convolve_tile<conv1_tile, wide>(job, tile, 2 * y + 1, 2 * x, v, lower);
  THERMORIG_UNROLL
  for (int o = 0; o < conv1_tile; ++o) {
    THERMORIG_UNROLL
    for (int c = 0; c < cells; ++c) {
      Vector best = upper[o][2 * c];
      Mask choice{};
      const auto beat = [&](Vector other, int number) {
        choice = other > best ? number - Mask{} : choice;
        best = other > best ? other : best;
      };
      beat(upper[o][2 * c + 1], 1);
      beat(lower[o][2 * c], 2);
      beat(lower[o][2 * c + 1], 3);
      choice = best > 0.0F ? choice : 4 - Mask{};
      const int channel = tile * conv1_tile + o;
      store(at(job.output, channel, y, x + c) + v, relu(best));
      int* const chosen = choices.first + channel * choices.plane + y * choices.row + (x + c) * cell + v;
      *reinterpret_cast<Mask*>(chosen) = choice;
    }
  }
}

}  // namespace

/// (Nf, H, W) to (6, H1 / 2, W1 / 2)
void convolve_and_pool(const ConvolutionJob& job, const Choices& choices, int first_row, int last_row) {
  constexpr int most = accumulators / conv1_tile / 2;
  for (int y = first_row; y < last_row; ++y) {
    for (int v = 0; v < cell; v += lanes) {
      for (int tile = 0; tile < job.outputs / conv1_tile; ++tile) {
        int x = 0;
        for (; x + most <= job.columns; x += most) pool<most>(job, choices, tile, y, x, v);
        for (; x < job.columns; ++x) pool<1>(job, choices, tile, y, x, v);
      }
    }
  }
}

/// (6, H1 / 2, W1 / 2), through max-pool and ReLU, to the gradients of (6, Nf, 5, 5) weights and 6 biases
void conv1_gradient(const ConvolutionGradientJob& job, int first_unit, int last_unit) {
  weight_gradient<accumulators == 24 ? 3 : 2, 2>(job, first_unit, last_unit);
}

// ---- Conv2, ReLU ----

/// (6, H1 / 2, W1 / 2) to (16, H2, W2)
void convolve_relu(const ConvolutionJob& job, int first_row, int last_row) {
  convolve_rows<conv2_tile>(job, first_row, last_row,
                            [&](float* out, Vector value) { store(out, relu(value)); });
}

/// The gradient of Conv2's input is the convolution of its output's gradient with the weights turned by 180
/// degrees: (16, H2, W2) to (6, H1 / 2, W1 / 2)
void convolve(const ConvolutionJob& job, int first_row, int last_row) {
  convolve_rows<conv2_input_tile>(job, first_row, last_row, store);
}

/// (16, H2, W2) to the gradients of (16, 6, 5, 5) weights and 16 biases
void conv2_gradient(const ConvolutionGradientJob& job, int first_unit, int last_unit) {
  weight_gradient<accumulators == 24 ? 4 : 2, 1>(job, first_unit, last_unit);
}

}  // namespace thermorig::network::THERMORIG_KERNELS
