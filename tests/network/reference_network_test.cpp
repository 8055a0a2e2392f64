// SPDX-License-Identifier: MIT
// The reference itself is held against finite differences, layer by layer; all of it against PyTorch
// (golden_test.cpp).
#include "reference_network.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "random_windows.h"

namespace thermorig::network {
namespace {

Values random_values(Draw& draw, std::size_t size) {
  Values values(size);
  for (double& v : values) v = draw();
  return values;
}

Maps random_maps(Draw& draw, int channels, int rows, int columns) {
  Maps maps{channels, rows, columns};
  for (double& v : maps.values) v = draw();
  return maps;
}

double dot(const Values& a, const Values& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// Central differences of `loss` by each of `values`, which it reads, against `derivatives`.
void expect_slopes(Values& values, const Values& derivatives, const std::function<double()>& loss,
                   double tolerance = 1e-8) {
  ASSERT_EQ(values.size(), derivatives.size());
  const double h = 1e-5;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = values[i];
    values[i] = value + h;
    const double above = loss();
    values[i] = value - h;
    const double below = loss();
    values[i] = value;
    EXPECT_NEAR(derivatives[i], (above - below) / (2.0 * h), tolerance) << "value " << i;
  }
}

TEST(ReferenceLayers, ConvolutionsSlopesAreItsDifferences) {
  for (int padding : {0, 1, 2}) {
    Draw draw(1);
    Maps x = random_maps(draw, 2, 6, 7);
    Values weight = random_values(draw, 3 * 2 * 25), bias = random_values(draw, 3);
    const Maps dy = random_maps(draw, 3, 2 + 2 * padding, 3 + 2 * padding);
    const auto loss = [&] { return dot(convolution(x, weight, bias, padding).values, dy.values); };
    Values dweight(weight.size()), dbias(bias.size());
    const Maps dx = convolution_backward(x, weight, padding, dy, dweight, dbias);
    expect_slopes(x.values, dx.values, loss);
    expect_slopes(weight, dweight, loss);
    expect_slopes(bias, dbias, loss);
  }
}

TEST(ReferenceLayers, ConvolutionIsACrossCorrelation) {
  Maps x{1, 5, 5};
  x.at(0, 1, 3) = 2.0;
  Values weight(25);
  weight[1 * 5 + 3] = 7.0;
  EXPECT_EQ(convolution(x, weight, Values{0.5}, 0).values, Values{14.5});
}

TEST(ReferenceLayers, PoolingsSlopesAreItsDifferencesAndAnOddEdgeHasNone) {
  Draw draw(2);
  Maps x = random_maps(draw, 2, 5, 7);
  const Maps dy = random_maps(draw, 2, 2, 3);
  const Maps dx = max_pooling_backward(x, dy);
  expect_slopes(x.values, dx.values, [&] { return dot(max_pooling(x).values, dy.values); });
  EXPECT_EQ(dx.at(0, 4, 0), 0.0);
  EXPECT_EQ(dx.at(1, 0, 6), 0.0);
}

TEST(ReferenceLayers, DenseSlopesAreItsDifferences) {
  Draw draw(3);
  Values x = random_values(draw, 9), weight = random_values(draw, 4 * 9), bias = random_values(draw, 4);
  const Values dy = random_values(draw, 4);
  const auto loss = [&] { return dot(dense(x, weight, bias), dy); };
  Values dweight(weight.size()), dbias(bias.size());
  const Values dx = dense_backward(x, weight, dy, dweight, dbias);
  expect_slopes(x, dx, loss);
  expect_slopes(weight, dweight, loss);
  expect_slopes(bias, dbias, loss);
}

TEST(ReferenceLayers, ReluAndSigmoidsSlopesAreTheirDifferences) {
  Draw draw(4);
  Values x = random_values(draw, 20);
  const Values dy = random_values(draw, 20);
  expect_slopes(x, relu_backward(relu(x), dy), [&] { return dot(relu(x), dy); });
  for (double value : {-3.0, -0.1, 0.0, 2.0}) {
    Values at{value};
    expect_slopes(at, {sigmoid_backward(sigmoid(value), 1.5)}, [&] { return 1.5 * sigmoid(at[0]); });
  }
}

TEST(ReferenceLayers, BerHuIsThePapersAndSmoothWhereItsPiecesMeet) {
  const Values errors{0.1, -1.0, 0.2, 0.5};  // c = 0.2
  const BerHu result = berhu(errors, 0.2);
  EXPECT_NEAR(result.loss, (0.1 + (1.0 + 0.04) / 0.4 + 0.2 + (0.25 + 0.04) / 0.4) / 4.0, 1e-12);
  const Values slopes{1.0, -5.0, 1.0, 2.5};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(result.derrors[i], slopes[i] / 4.0, 1e-12);
}

TEST(ReferenceLayers, BerHuOfNoErrorIsZero) {
  const BerHu result = berhu(Values{0.0, 0.0}, 0.2);
  EXPECT_EQ(result.loss, 0.0);
  EXPECT_EQ(result.derrors, (Values{0.0, 0.0}));
}

TEST(ReferenceNetwork, MirroringIsTheFlippedImage) {
  const Shape shape{.frames = 2, .reduction = 3};
  const ReferenceNetwork network(initial_weights(shape, 3));
  RandomWindows plain(shape, 4, 5);
  RandomWindows flipped = plain;
  for (std::size_t b : {1, 3})
    for (auto row = flipped.frames[b].begin(); row != flipped.frames[b].end(); row += shape.columns())
      std::reverse(row, row + shape.columns());
  flipped.mirrored.clear();
  EXPECT_EQ(network.gradients(plain.batch(), {}).values, network.gradients(flipped.batch(), {}).values);
}

TEST(ReferenceNetwork, AdamsFirstStepIsTheRateAgainstEachSlope) {
  const Shape shape{.frames = 2, .reduction = 3};
  ReferenceNetwork network(initial_weights(shape, 3));
  RandomWindows windows(shape, 4, 5);
  const Values before = network.weights();
  const Values slopes = network.gradients(windows.batch(), {}).values;
  network.step(windows.batch(), {}, {});
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_NEAR(network.weights()[i] - before[i], -1e-3 * slopes[i] / (std::abs(slopes[i]) + 1e-8), 1e-9);
}

}  // namespace
}  // namespace thermorig::network
