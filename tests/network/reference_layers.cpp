// SPDX-License-Identifier: MIT
#include "reference_layers.h"

#include <algorithm>
#include <cmath>

#include "thermorig/network/shape.h"

namespace thermorig::network {

namespace {

Maps padded(const Maps& x, int padding) {
  Maps wide{x.channels, x.rows + 2 * padding, x.columns + 2 * padding};
  for (int c = 0; c < x.channels; ++c)
    for (int row = 0; row < x.rows; ++row)
      for (int column = 0; column < x.columns; ++column)
        wide.at(c, row + padding, column + padding) = x.at(c, row, column);
  return wide;
}

Maps cropped(const Maps& wide, int padding) {
  Maps x{wide.channels, wide.rows - 2 * padding, wide.columns - 2 * padding};
  for (int c = 0; c < x.channels; ++c)
    for (int row = 0; row < x.rows; ++row)
      for (int column = 0; column < x.columns; ++column)
        x.at(c, row, column) = wide.at(c, row + padding, column + padding);
  return x;
}

/// Calls term(weight index, filter, row, column, channel, input row, input column) for every product that the
/// convolution sums.
template <typename Term>
void for_each_product(const Maps& wide, const Maps& y, Term term) {
  std::size_t w = 0;
  for (int f = 0; f < y.channels; ++f)
    for (int c = 0; c < wide.channels; ++c)
      for (int i = 0; i < kernel_size; ++i)
        for (int j = 0; j < kernel_size; ++j, ++w)
          for (int row = 0; row < y.rows; ++row)
            for (int column = 0; column < y.columns; ++column)
              term(w, f, row, column, c, row + i, column + j);
}

struct Place {
  int row, column;
};

/// Where the largest of a 2x2 block is; the first of equals.
Place largest(const Maps& x, int c, int row, int column) {
  Place best{2 * row, 2 * column};
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j)
      if (x.at(c, 2 * row + i, 2 * column + j) > x.at(c, best.row, best.column))
        best = {2 * row + i, 2 * column + j};
  return best;
}

}  // namespace

Maps convolution(const Maps& x, std::span<const double> weight, std::span<const double> bias, int padding) {
  const Maps wide = padded(x, padding);
  Maps y{static_cast<int>(bias.size()), wide.rows - (kernel_size - 1), wide.columns - (kernel_size - 1)};
  for (int f = 0; f < y.channels; ++f)
    for (int row = 0; row < y.rows; ++row)
      for (int column = 0; column < y.columns; ++column)
        y.at(f, row, column) = bias[static_cast<std::size_t>(f)];
  for_each_product(wide, y, [&](std::size_t w, int f, int row, int column, int c, int in_row, int in_column) {
    y.at(f, row, column) += weight[w] * wide.at(c, in_row, in_column);
  });
  return y;
}

Maps convolution_backward(const Maps& x, std::span<const double> weight, int padding, const Maps& dy,
                          std::span<double> dweight, std::span<double> dbias) {
  const Maps wide = padded(x, padding);
  Maps dwide{wide.channels, wide.rows, wide.columns};
  for_each_product(wide, dy,
                   [&](std::size_t w, int f, int row, int column, int c, int in_row, int in_column) {
                     dweight[w] += dy.at(f, row, column) * wide.at(c, in_row, in_column);
                     dwide.at(c, in_row, in_column) += dy.at(f, row, column) * weight[w];
                   });
  for (int f = 0; f < dy.channels; ++f)
    for (int row = 0; row < dy.rows; ++row)
      for (int column = 0; column < dy.columns; ++column)
        dbias[static_cast<std::size_t>(f)] += dy.at(f, row, column);
  return cropped(dwide, padding);
}

Maps max_pooling(const Maps& x) {
  Maps y{x.channels, x.rows / 2, x.columns / 2};
  for (int c = 0; c < y.channels; ++c)
    for (int row = 0; row < y.rows; ++row)
      for (int column = 0; column < y.columns; ++column) {
        const Place place = largest(x, c, row, column);
        y.at(c, row, column) = x.at(c, place.row, place.column);
      }
  return y;
}

Maps max_pooling_backward(const Maps& x, const Maps& dy) {
  Maps dx{x.channels, x.rows, x.columns};
  for (int c = 0; c < dy.channels; ++c)
    for (int row = 0; row < dy.rows; ++row)
      for (int column = 0; column < dy.columns; ++column) {
        const Place place = largest(x, c, row, column);
        dx.at(c, place.row, place.column) += dy.at(c, row, column);
      }
  return dx;
}

Values dense(std::span<const double> x, std::span<const double> weight, std::span<const double> bias) {
  Values y(bias.begin(), bias.end());
  for (std::size_t o = 0; o < y.size(); ++o)
    for (std::size_t i = 0; i < x.size(); ++i) y[o] += weight[o * x.size() + i] * x[i];
  return y;
}

Values dense_backward(std::span<const double> x, std::span<const double> weight, std::span<const double> dy,
                      std::span<double> dweight, std::span<double> dbias) {
  Values dx(x.size());
  for (std::size_t o = 0; o < dy.size(); ++o) {
    dbias[o] += dy[o];
    for (std::size_t i = 0; i < x.size(); ++i) {
      dweight[o * x.size() + i] += dy[o] * x[i];
      dx[i] += dy[o] * weight[o * x.size() + i];
    }
  }
  return dx;
}

Values relu(Values x) {
  for (double& value : x) value = std::max(value, 0.0);
  return x;
}

Values relu_backward(const Values& y, Values dy) {
  for (std::size_t i = 0; i < y.size(); ++i)
    if (y[i] <= 0.0) dy[i] = 0.0;
  return dy;
}

double sigmoid(double x) {
  return 1.0 / (1.0 + std::exp(-x));
}

double sigmoid_backward(double y, double dy) {
  return dy * y * (1.0 - y);
}

BerHu berhu(std::span<const double> errors, double fraction) {
  double largest_error = 0.0;
  for (double e : errors) largest_error = std::max(largest_error, std::abs(e));
  const double c = fraction * largest_error;
  BerHu result{0.0, Values(errors.size())};
  if (largest_error == 0.0) return result;
  const auto batch = static_cast<double>(errors.size());
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double e = errors[i];
    const bool linear = std::abs(e) <= c;
    result.loss += (linear ? std::abs(e) : (e * e + c * c) / (2.0 * c)) / batch;
    result.derrors[i] =
        (linear ? static_cast<double>(e > 0.0) - static_cast<double>(e < 0.0) : e / c) / batch;
  }
  return result;
}

}  // namespace thermorig::network
