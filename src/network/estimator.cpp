// SPDX-License-Identifier: MIT
#include "thermorig/network/estimator.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace thermorig::network {

struct Estimator::Parts {
  Weights weights;
  std::vector<float> conv1, pooled, conv2, hidden, second;
};

namespace {

std::size_t at(int a) {
  return static_cast<std::size_t>(a);
}

/// One channel-wise 5x5 convolution with ReLU. `in`: (C, H, W); `out`: (F, rows, columns).
void convolve(std::span<const float> in, int channels, int h, int w, std::span<const float> weight,
              std::span<const float> bias, int padding, int rows, int columns, std::span<float> out) {
  for (std::size_t f = 0; f < bias.size(); ++f)
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x) {
        float sum = bias[f];
        for (int c = 0; c < channels; ++c)
          for (int dy = 0; dy < kernel_size; ++dy)
            for (int dx = 0; dx < kernel_size; ++dx) {
              const int iy = y + dy - padding, ix = x + dx - padding;
              if (iy < 0 || iy >= h || ix < 0 || ix >= w) continue;
              sum += weight[((f * at(channels) + at(c)) * 5 + at(dy)) * 5 + at(dx)] *
                     in[at((c * h + iy) * w + ix)];
            }
        out[(f * at(rows) + at(y)) * at(columns) + at(x)] = std::max(sum, 0.0F);
      }
}

/// out = weight in + bias; `weight`: (out, in).
void connect(std::span<const float> in, std::span<const float> weight, std::span<const float> bias, bool relu,
             std::span<float> out) {
  for (std::size_t o = 0; o < out.size(); ++o) {
    float sum = bias[o];
    for (std::size_t i = 0; i < in.size(); ++i) sum += weight[o * in.size() + i] * in[i];
    out[o] = relu ? std::max(sum, 0.0F) : sum;
  }
}

}  // namespace

Estimator::Estimator(const Weights& weights, Precision, InstructionSet)
    : parts_(std::make_unique<Parts>(Parts{weights, {}, {}, {}, {}, {}})) {
  const Shape& s = weights.shape;
  parts_->conv1.resize(at(filters1 * s.rows1() * s.columns1()));
  parts_->pooled.resize(at(filters1 * s.pooled_rows() * s.pooled_columns()));
  parts_->conv2.resize(at(s.features()));
  parts_->hidden.resize(hidden1);
  parts_->second.resize(hidden2);
}

Estimator::~Estimator() = default;
Estimator::Estimator(Estimator&&) noexcept = default;
Estimator& Estimator::operator=(Estimator&&) noexcept = default;

const Shape& Estimator::shape() const {
  return parts_->weights.shape;
}

Output Estimator::estimate(std::span<const float> frames, float gyro) {
  Parts& p = *parts_;
  const Shape& s = shape();
  assert(frames.size() == s.inputs());
  const auto t = [&](std::string_view name) { return std::as_const(p.weights).tensor(name); };
  convolve(frames, s.frames, s.rows(), s.columns(), t("conv1.weight"), t("conv1.bias"), s.padding1, s.rows1(),
           s.columns1(), p.conv1);
  std::size_t n = 0;
  for (int c = 0; c < filters1; ++c)
    for (int y = 0; y < s.pooled_rows(); ++y)
      for (int x = 0; x < s.pooled_columns(); ++x) {
        const float* v = &p.conv1[at((c * s.rows1() + 2 * y) * s.columns1() + 2 * x)];
        p.pooled[n++] = std::max(std::max(v[0], v[1]), std::max(v[s.columns1()], v[s.columns1() + 1]));
      }
  convolve(p.pooled, filters1, s.pooled_rows(), s.pooled_columns(), t("conv2.weight"), t("conv2.bias"),
           s.padding2, s.rows2(), s.columns2(), p.conv2);
  Output out;
  connect(p.conv2, t("speed1.weight"), t("speed1.bias"), true, p.hidden);
  connect(p.hidden, t("speed2.weight"), t("speed2.bias"), true, p.second);
  connect(p.second, t("speed3.weight"), t("speed3.bias"), false, {&out.thermal, 1});
  out.fusion = out.thermal;
  if (!s.fusion) return out;
  float logit = 0.0F;
  connect(p.conv2, t("gain1.weight"), t("gain1.bias"), true, p.hidden);
  connect(p.hidden, t("gain2.weight"), t("gain2.bias"), false, {&logit, 1});
  out.gain = 1.0F / (1.0F + std::exp(-logit));
  out.fusion = out.gain * out.thermal + (1.0F - out.gain) * gyro;
  return out;
}

}  // namespace thermorig::network
