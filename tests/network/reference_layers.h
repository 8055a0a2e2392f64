// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

namespace thermorig::network {

// The layers of the paper's network in plain double precision, forward and backward side by side, without a
// thought for speed: what the kernels are held against. `dx` is the derivative of the loss by x. Backward
// functions return the derivative by the input and add that by weights and biases to what is there.

using Values = std::vector<double>;

/// Channels of rows x columns, row-major.
struct Maps {
  int channels = 0, rows = 0, columns = 0;
  Values values = Values(static_cast<std::size_t>(channels * rows * columns));

  double& at(int channel, int row, int column) { return values[index(channel, row, column)]; }
  double at(int channel, int row, int column) const { return values[index(channel, row, column)]; }

 private:
  std::size_t index(int channel, int row, int column) const {
    return static_cast<std::size_t>((channel * rows + row) * columns + column);
  }
};

/// Paper section III: 5x5 filters, zeros around the input; a cross-correlation, as in PyTorch. x (C, H, W),
/// weight (F, C, 5, 5), bias (F) -> (F, H + 2 padding - 4, W + 2 padding - 4).
Maps convolution(const Maps& x, std::span<const double> weight, std::span<const double> bias, int padding);
Maps convolution_backward(const Maps& x, std::span<const double> weight, int padding, const Maps& dy,
                          std::span<double> dweight, std::span<double> dbias);

/// Largest of 2x2; an odd last row or column is dropped. (C, H, W) -> (C, H / 2, W / 2).
Maps max_pooling(const Maps& x);
Maps max_pooling_backward(const Maps& x, const Maps& dy);

/// weight (outputs, inputs), bias (outputs).
Values dense(std::span<const double> x, std::span<const double> weight, std::span<const double> bias);
Values dense_backward(std::span<const double> x, std::span<const double> weight, std::span<const double> dy,
                      std::span<double> dweight, std::span<double> dbias);

Values relu(Values x);
/// `y`: what relu returned.
Values relu_backward(const Values& y, Values dy);

double sigmoid(double x);
/// `y`: what sigmoid returned.
double sigmoid_backward(double y, double dy);

/// Inverted Huber loss (paper eq. 3), mean over the batch, and its derivative by each error; c is a constant
/// to the derivative.
struct BerHu {
  double loss = 0.0;
  Values derrors;
};
BerHu berhu(std::span<const double> errors, double fraction);

}  // namespace thermorig::network
