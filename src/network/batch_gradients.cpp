// SPDX-License-Identifier: MIT
#include "batch_gradients.h"

#include "loss.h"

namespace thermorig::network {

namespace {

constexpr int window = taps * taps;
constexpr int most_lanes = 16;

/// The cells around the output of Conv2 that its input's gradient reaches into.
int turned_margin(const Shape& shape) {
  return taps - 1 - shape.padding2;
}

/// Where each feature's cell is; those that only fill up the last block share the cell behind.
std::vector<int> places_of_features(const Shape& shape, int blocks, const PlanesArray& planes) {
  std::vector<int> places;
  for (int channel = 0; channel < filters2; ++channel)
    for (int y = 0; y < shape.rows2(); ++y)
      for (int x = 0; x < shape.columns2(); ++x) places.push_back(planes.place(channel, y, x));
  places.resize(static_cast<std::size_t>(blocks * block), planes.place_behind());
  return places;
}

/// The weights of the convolution that is the gradient: inputs and outputs changed over, taps turned by 180
/// degrees. (outputs, inputs, 5, 5) to (1, outputs, 5, 5, inputs)
void turn(const float* weights, int outputs, int inputs, float* turned) {
  for (int o = 0; o < outputs; ++o)
    for (int tap = window - 1; tap >= 0; --tap)
      for (int i = 0; i < inputs; ++i) *turned++ = weights[(o * inputs + i) * window + tap];
}

std::size_t cells(int count) {
  return static_cast<std::size_t>(count) * cell;
}

}  // namespace

BatchGradients::BatchGradients(BatchNetwork& network)
    : network_(network),
      gradient_(network.layout().size()),
      first_(network.layout().size()),
      second_(network.layout().size()),
      thermal_(cell),
      gain_(cell),
      hidden_first_(cells(2 * head_cells)),
      hidden_second_(cells(hidden2)),
      features_(filters2, network.shape().rows2(), network.shape().columns2(),
                turned_margin(network.shape())),
      pooled_(filters1, network.shape().pooled_rows(), network.shape().pooled_columns(), 0),
      turned_(static_cast<std::size_t>(filters2 * filters1 * window)),
      sums1_(static_cast<std::size_t>(filters1 * network.shape().frames * window * most_lanes)),
      sums2_(static_cast<std::size_t>(filters2 * filters1 * window * most_lanes)),
      hidden_places_(head_cells),
      feature_places_(places_of_features(network.shape(), network.layout().blocks(), features_)) {
  for (int unit = 0; unit < head_cells; ++unit) hidden_places_[static_cast<std::size_t>(unit)] = unit * cell;
}

void BatchGradients::begin(const AdamSteps* adam) {
  adam_ = adam;
  turn(network_.at(network_.layout().conv2_weight()), filters2, filters1, turned_.data());
}

DenseGradientJob BatchGradients::dense_job(std::size_t place, AdamStep AdamSteps::*adam) {
  DenseGradientJob job{};
  job.weights = network_.at(place);
  job.first_moment = first_.data() + place;
  job.second_moment = second_.data() + place;
  if (adam_)
    job.adam = adam_->*adam;
  else
    job.weight_gradient = gradient_at(place);
  return job;
}

StepLoss BatchGradients::heads(const Batch& batch, const LossConfig& config) {
  const TrainingKernels& kernels = network_.kernels();
  const BatchLayout& layout = network_.layout();
  const bool fusion = network_.shape().fusion;
  const std::size_t samples = batch.frames.size();
  const auto cell_part = [samples](AlignedFloats& values) { return std::span(values.data(), samples); };

  thermal_.clear();  // lanes without a window have no gradient
  gain_.clear();
  BatchOutputs outputs{.thermal = cell_part(network_.thermal), .label = batch.label};
  if (fusion) {
    outputs.gain = cell_part(network_.gain);
    outputs.gyro = batch.gyro;
  }
  const StepLoss loss = loss_of(outputs, config, cell_part(thermal_), cell_part(gain_));

  kernels.readout_gradient({hidden2, network_.at(layout.speed3_weight()), network_.hidden_second.data(),
                            thermal_.data(), gradient_at(layout.speed3_weight()),
                            gradient_at(layout.speed3_bias()), hidden_second_.data()});
  if (fusion)
    kernels.readout_gradient({hidden1, network_.at(layout.gain2_weight()),
                              network_.hidden_first.data() + head_cells * cell, gain_.data(),
                              gradient_at(layout.gain2_weight()), gradient_at(layout.gain2_bias()),
                              hidden_first_.data() + head_cells * cell});

  DenseGradientJob job = dense_job(layout.dense2(), &AdamSteps::others);
  job.heads = 1;
  job.head_rows = hidden2;
  job.head_cells = hidden2;
  job.blocks = head_cells / block;
  job.gradient = hidden_second_.data();
  job.input = network_.hidden_first.data();
  job.input_gradient = hidden_first_.data();
  job.place_of = hidden_places_.data();
  kernels.dense_gradient(job, 0, job.blocks);

  kernels.sum_cells(hidden_second_.data(), hidden2, gradient_at(layout.speed2_bias()));
  kernels.sum_cells(hidden_first_.data(), hidden1, gradient_at(layout.speed1_bias()));
  if (fusion)
    kernels.sum_cells(hidden_first_.data() + head_cells * cell, hidden1, gradient_at(layout.gain1_bias()));
  return loss;
}

void BatchGradients::dense1(Share share) {
  DenseGradientJob job = dense_job(network_.layout().dense1(), &AdamSteps::wide);
  job.heads = network_.layout().heads();
  job.head_rows = hidden1;
  job.head_cells = head_cells;
  job.blocks = network_.layout().blocks();
  job.gradient = hidden_first_.data();
  job.input = network_.features.data();
  job.input_gradient = features_.with_margin().first;
  job.place_of = feature_places_.data();
  network_.kernels().dense_gradient(job, share.first(job.blocks), share.last(job.blocks));
}

void BatchGradients::convolve2_input(Share share) {
  const Shape& shape = network_.shape();
  const ConvolutionJob input{.input = features_.with_margin(),
                             .input_channels = filters2,
                             .weights = turned_.data(),
                             .bias = nullptr,
                             .output = pooled_.inner(),
                             .outputs = filters1,
                             .rows = shape.pooled_rows(),
                             .columns = shape.pooled_columns()};
  network_.kernels().convolve(input, share.first(input.rows), share.last(input.rows));
}

void BatchGradients::convolve2_weights(Share share) {
  const Shape& shape = network_.shape();
  const ConvolutionGradientJob weights{.gradient = features_.inner(),
                                       .choices = {},
                                       .input = network_.pooled.with_margin(),
                                       .outputs = filters2,
                                       .input_channels = filters1,
                                       .rows = shape.rows2(),
                                       .columns = shape.columns2(),
                                       .sums = sums2_.data(),
                                       .weight_gradient = gradient_at(network_.layout().conv2_weight()),
                                       .bias_gradient = gradient_at(network_.layout().conv2_bias())};
  network_.kernels().conv2_gradient(weights, share.first(filters1 * taps), share.last(filters1 * taps));
}

void BatchGradients::convolve1(Share share) {
  const Shape& shape = network_.shape();
  const ConvolutionGradientJob weights{.gradient = pooled_.inner(),
                                       .choices = network_.choices(),
                                       .input = network_.input.with_margin(),
                                       .outputs = filters1,
                                       .input_channels = shape.frames,
                                       .rows = shape.pooled_rows(),
                                       .columns = shape.pooled_columns(),
                                       .sums = sums1_.data(),
                                       .weight_gradient = gradient_at(network_.layout().conv1_weight()),
                                       .bias_gradient = gradient_at(network_.layout().conv1_bias())};
  network_.kernels().conv1_gradient(weights, share.first(shape.frames * taps),
                                    share.last(shape.frames * taps));
}

void BatchGradients::change_small_tensors() {
  const std::size_t small = network_.layout().small();
  const int count = static_cast<int>(network_.layout().size() - small);
  network_.kernels().adam(adam_->others, count, gradient_at(small), network_.at(small), first_.data() + small,
                          second_.data() + small);
  network_.pack_convolutions();
}

}  // namespace thermorig::network
