// SPDX-License-Identifier: MIT
#include "bias_evidence.h"

#include <algorithm>
#include <cmath>

namespace thermorig::odometer {

namespace {

constexpr std::size_t scales = 23;
constexpr double reach_sigmas = 2.2;
constexpr double wrong_share = 0.3;  // of the searches, which name anything
constexpr double clear_bias_dps = 3.0, clear_scale = 0.02;
// Time stamps, rows and lens are off in all searches alike.
constexpr double least_bias_sigma_dps = 0.5, least_scale_sigma = 0.004;

}  // namespace

BiasEvidence::BiasEvidence(const Priors& priors)
    : priors_(priors), logs_(scales * BiasSearch::most_steps), of_curve_(BiasSearch::most_steps) {}

void BiasEvidence::clear() {
  biases_ = 0;
  found_.reset();
}

std::size_t BiasEvidence::size() const {
  return scales * biases_;
}

BiasEvidence::Offset BiasEvidence::offset(std::size_t place) const {
  constexpr double middle = (scales - 1) / 2.0;
  const std::size_t bias = place % biases_, scale = place / biases_;
  return {(static_cast<double>(bias) - 0.5 * (static_cast<double>(biases_) - 1.0)) * step_dps_,
          reach_sigmas * priors_.scale_sigma * (static_cast<double>(scale) / middle - 1.0)};
}

void BiasEvidence::begin(const BiasSearch::Curve& curve) {
  biases_ = curve.variances.size();
  step_dps_ = curve.step_dps;
  for (std::size_t i = 0; i < size(); ++i) {
    const Offset off = offset(i);
    logs_[i] = std::log(bias_before(off.bias_dps, priors_)) - 0.5 * square(off.scale / priors_.scale_sigma);
  }
}

/// A search may be wrong: then each bias is as likely as any other.
void BiasEvidence::weigh(const BiasSearch::Curve& curve) {
  double sum = 0.0;
  for (std::size_t i = 0; i < biases_; ++i)
    sum += of_curve_[i] = curve.likelihood(i, BiasSearch::trusted_with_care);
  for (std::size_t i = 0; i < biases_; ++i)
    of_curve_[i] =
        std::log((1.0 - wrong_share) * of_curve_[i] / sum + wrong_share / static_cast<double>(biases_));
}

void BiasEvidence::add(const BiasSearch::Curve& curve) {
  if (!curve.is_distinct) return;
  if (biases_ != curve.variances.size()) begin(curve);
  weigh(curve);
  const double last = static_cast<double>(biases_) - 1.0;
  for (std::size_t i = 0; i < size(); ++i) {
    const Offset off = offset(i);
    const double turned_dps =
        (curve.read_dps - priors_.bias_dps - off.bias_dps) / (priors_.scale + off.scale);
    const double named_dps =
        off.bias_dps + off.scale * turned_dps;  // by a search that takes the expected scale
    const double at = std::clamp(named_dps / step_dps_ + 0.5 * last, 0.0, last - 1e-6);
    const auto below = static_cast<std::size_t>(at);
    logs_[i] += std::lerp(of_curve_[below], of_curve_[below + 1], at - static_cast<double>(below));
  }
  find();
}

void BiasEvidence::find() {
  const double most = *std::max_element(logs_.begin(), logs_.begin() + static_cast<std::ptrdiff_t>(size()));
  double sum = 0.0, bias = 0.0, scale = 0.0, bias2 = 0.0, scale2 = 0.0, both = 0.0;
  for (std::size_t i = 0; i < size(); ++i) {
    const double weight = std::exp(logs_[i] - most);
    const Offset off = offset(i);
    sum += weight;
    bias += weight * off.bias_dps;
    scale += weight * off.scale;
    bias2 += weight * square(off.bias_dps);
    scale2 += weight * square(off.scale);
    both += weight * off.bias_dps * off.scale;
  }
  bias /= sum;
  scale /= sum;
  const auto sigma = [&](double squares, double mean, double least) {
    return std::sqrt(std::max(0.0, squares / sum - mean * mean) + square(least));
  };
  Priors found = priors_;
  found.bias_dps += bias;
  found.scale += scale;
  found.bias_sigma_dps = sigma(bias2, bias, least_bias_sigma_dps);
  found.scale_sigma = sigma(scale2, scale, least_scale_sigma);
  found.bias_scale_covariance = both / sum - bias * scale;
  found_.reset();
  if (found.bias_sigma_dps < clear_bias_dps && found.scale_sigma < clear_scale) found_ = found;
}

}  // namespace thermorig::odometer
