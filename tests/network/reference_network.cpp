// SPDX-License-Identifier: MIT
#include "reference_network.h"

#include <algorithm>
#include <cmath>

namespace thermorig::network {

/// What a window's forward pass leaves for the backward pass.
struct ReferenceNetwork::Activations {
  double gyro = 0.0;
  Maps frames;            // (Nf, H, W)
  Maps conv1;             // (6, rows1, columns1) after ReLU
  Maps pooled;            // (6, pooled_rows, pooled_columns)
  Maps conv2;             // (16, rows2, columns2) after ReLU; its values are the features
  Values speed1, speed2;  // (120), (80) after ReLU
  Values gain1;           // (120) after ReLU
  ReferenceOutput output;
};

namespace {

Maps maps_of(std::span<const float> frames, const Shape& shape, bool mirrored) {
  Maps maps{shape.frames, shape.rows(), shape.columns()};
  std::copy(frames.begin(), frames.end(), maps.values.begin());
  if (!mirrored) return maps;
  for (auto row = maps.values.begin(); row != maps.values.end(); row += shape.columns())
    std::reverse(row, row + shape.columns());
  return maps;
}

}  // namespace

ReferenceNetwork::ReferenceNetwork(const Weights& weights)
    : shape_(weights.shape),
      tensors_(tensors_of(weights.shape)),
      weights_(weights.values.begin(), weights.values.end()),
      first_(weights_.size()),
      second_(weights_.size()) {}

const Tensor& ReferenceNetwork::place(std::string_view name) const {
  return *std::find_if(tensors_.begin(), tensors_.end(), [&](const Tensor& t) { return t.name == name; });
}

std::span<const double> ReferenceNetwork::tensor(std::string_view name) const {
  return std::span(weights_).subspan(place(name).offset, place(name).size);
}

ReferenceNetwork::Activations ReferenceNetwork::run(Maps frames, double gyro) const {
  const auto w = [this](std::string_view name) { return tensor(name); };
  Activations a{.gyro = gyro, .frames = std::move(frames)};
  a.conv1 = convolution(a.frames, w("conv1.weight"), w("conv1.bias"), shape_.padding1);
  a.conv1.values = relu(a.conv1.values);
  a.pooled = max_pooling(a.conv1);
  a.conv2 = convolution(a.pooled, w("conv2.weight"), w("conv2.bias"), shape_.padding2);
  a.conv2.values = relu(a.conv2.values);
  const Values& features = a.conv2.values;
  a.speed1 = relu(dense(features, w("speed1.weight"), w("speed1.bias")));
  a.speed2 = relu(dense(a.speed1, w("speed2.weight"), w("speed2.bias")));
  a.output.thermal = dense(a.speed2, w("speed3.weight"), w("speed3.bias"))[0];
  a.output.fusion = a.output.thermal;
  if (!shape_.fusion) return a;
  a.gain1 = relu(dense(features, w("gain1.weight"), w("gain1.bias")));
  a.output.gain = sigmoid(dense(a.gain1, w("gain2.weight"), w("gain2.bias"))[0]);
  // Paper eq. 2.
  a.output.fusion = a.output.gain * a.output.thermal + (1.0 - a.output.gain) * gyro;
  return a;
}

void ReferenceNetwork::run_backward(const Activations& a, double dfusion, double dthermal,
                                    Values& gradients) const {
  const auto w = [this](std::string_view name) { return tensor(name); };
  const auto d = [&](std::string_view name) {
    return std::span(gradients).subspan(place(name).offset, place(name).size);
  };
  const Values dspeed3{dthermal + dfusion * a.output.gain};
  const Values dspeed2 = relu_backward(
      a.speed2, dense_backward(a.speed2, w("speed3.weight"), dspeed3, d("speed3.weight"), d("speed3.bias")));
  const Values dspeed1 = relu_backward(
      a.speed1, dense_backward(a.speed1, w("speed2.weight"), dspeed2, d("speed2.weight"), d("speed2.bias")));
  const Values& features = a.conv2.values;
  Values dfeatures =
      dense_backward(features, w("speed1.weight"), dspeed1, d("speed1.weight"), d("speed1.bias"));
  if (shape_.fusion) {
    const Values dgain2{sigmoid_backward(a.output.gain, dfusion * (a.output.thermal - a.gyro))};
    const Values dgain1 = relu_backward(
        a.gain1, dense_backward(a.gain1, w("gain2.weight"), dgain2, d("gain2.weight"), d("gain2.bias")));
    const Values more =
        dense_backward(features, w("gain1.weight"), dgain1, d("gain1.weight"), d("gain1.bias"));
    for (std::size_t i = 0; i < more.size(); ++i) dfeatures[i] += more[i];
  }
  Maps dconv2 = a.conv2;
  dconv2.values = relu_backward(features, dfeatures);
  const Maps dpooled = convolution_backward(a.pooled, w("conv2.weight"), shape_.padding2, dconv2,
                                            d("conv2.weight"), d("conv2.bias"));
  Maps dconv1 = max_pooling_backward(a.conv1, dpooled);
  dconv1.values = relu_backward(a.conv1.values, dconv1.values);
  convolution_backward(a.frames, w("conv1.weight"), shape_.padding1, dconv1, d("conv1.weight"),
                       d("conv1.bias"));
}

ReferenceOutput ReferenceNetwork::forward(std::span<const float> frames, double gyro) const {
  return run(maps_of(frames, shape_, false), gyro).output;
}

ReferenceGradients ReferenceNetwork::gradients(const Batch& batch, const LossConfig& config) const {
  const std::size_t size = batch.label.size();
  std::vector<Activations> windows;
  Values fusion_errors, thermal_errors;
  ReferenceGradients result{{.gain_mean = 0.0}, Values(weights_.size())};
  for (std::size_t b = 0; b < size; ++b) {
    const bool mirrored = !batch.mirrored.empty() && batch.mirrored[b] != 0;
    const double gyro = batch.gyro.empty() ? 0.0 : static_cast<double>(batch.gyro[b]);
    windows.push_back(run(maps_of({batch.frames[b], shape_.inputs()}, shape_, mirrored), gyro));
    const ReferenceOutput& y = windows.back().output;
    fusion_errors.push_back(y.fusion - static_cast<double>(batch.label[b]));
    thermal_errors.push_back(y.thermal - static_cast<double>(batch.label[b]));
    result.loss.squared_error += fusion_errors[b] * fusion_errors[b] / static_cast<double>(size);
    result.loss.gain_mean += y.gain / static_cast<double>(size);
  }
  const BerHu fusion = berhu(fusion_errors, static_cast<double>(config.berhu_fraction));
  const BerHu thermal = berhu(thermal_errors, static_cast<double>(config.berhu_fraction));
  const auto auxiliary = static_cast<double>(config.auxiliary_thermal);
  result.loss.loss = fusion.loss + auxiliary * thermal.loss;
  for (std::size_t b = 0; b < size; ++b)
    run_backward(windows[b], fusion.derrors[b], auxiliary * thermal.derrors[b], result.values);
  return result;
}

StepLoss ReferenceNetwork::step(const Batch& batch, const LossConfig& loss, const AdamConfig& adam) {
  const ReferenceGradients g = gradients(batch, loss);
  ++steps_;
  const auto steps = static_cast<double>(steps_);
  const auto beta1 = static_cast<double>(adam.beta1), beta2 = static_cast<double>(adam.beta2);
  // Kingma & Ba 2015, algorithm 1.
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    first_[i] = beta1 * first_[i] + (1.0 - beta1) * g.values[i];
    second_[i] = beta2 * second_[i] + (1.0 - beta2) * g.values[i] * g.values[i];
    const double first_unbiased = first_[i] / (1.0 - std::pow(beta1, steps));
    const double second_unbiased = second_[i] / (1.0 - std::pow(beta2, steps));
    weights_[i] -= static_cast<double>(adam.rate) * first_unbiased /
                   (std::sqrt(second_unbiased) + static_cast<double>(adam.epsilon));
  }
  return g.loss;
}

}  // namespace thermorig::network
