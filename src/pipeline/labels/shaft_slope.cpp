// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/shaft_slope.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <numbers>
#include <utility>

namespace thermorig::labels {

ShaftSlope::ShaftSlope(std::vector<double> gain, std::vector<ServoResponse::Ripple> ripples,
                       const PulseScale& scale)
    : scale_(scale), gain_(std::move(gain)), ripples_(std::move(ripples)) {
  if (gain_.empty()) gain_ = {1.0, 1.0};
  if (gain_.size() == 1) gain_.push_back(gain_.front());
  is_even_ = std::adjacent_find(gain_.begin(), gain_.end(), std::not_equal_to<>()) == gain_.end();
  turned_ = {0.0};
  for (std::size_t i = 0; i + 1 < gain_.size(); ++i)
    turned_.push_back(turned_.back() + (gain_[i] + gain_[i + 1]) / 2.0);
  middle_ = knots_turned(place(0.0));
}

/// Between the knots, and beyond them by as much.
double ShaftSlope::place(double value) const {
  return (scale_.part(value) + 1.0) / 2.0 * static_cast<double>(gain_.size() - 1);
}

double ShaftSlope::gain(double value) const {
  if (is_even_) return gain_.front();
  const double last = static_cast<double>(gain_.size() - 1);
  // fmin and fmax: a value that is not a number has a place as well.
  const double within = std::fmax(0.0, std::fmin(place(value), last));
  const std::size_t left = std::min(static_cast<std::size_t>(within), gain_.size() - 2);
  return std::lerp(gain_[left], gain_[left + 1], within - static_cast<double>(left));
}

double ShaftSlope::knots_turned(double place) const {
  const double last = static_cast<double>(gain_.size() - 1);
  const double within = std::fmax(0.0, std::fmin(place, last));
  const std::size_t left = std::min(static_cast<std::size_t>(within), gain_.size() - 2);
  const double share = within - static_cast<double>(left);
  const double beyond = place < 0.0    ? place * gain_.front()
                        : place > last ? (place - last) * gain_.back()
                                       : 0.0;
  return turned_[left] + share * (gain_[left] + share * (gain_[left + 1] - gain_[left]) / 2.0) + beyond;
}

double ShaftSlope::gained_deg(double angle_deg) const {
  const double knot_deg = 1.0 / (place(1.0) - place(0.0));
  return knot_deg * (knots_turned(place(angle_deg)) - middle_);
}

double ShaftSlope::at(double angle_deg, bool forward) const {
  double share = 1.0;
  if (!ripples_.empty()) {
    const double gained = gained_deg(angle_deg);
    for (const ServoResponse::Ripple& ripple : ripples_) {
      const double phase = 2.0 * std::numbers::pi * gained / ripple.period_deg;
      const double cosine = forward ? ripple.forward_cosine : ripple.backward_cosine;
      const double sine = forward ? ripple.forward_sine : ripple.backward_sine;
      share += cosine * std::cos(phase) + sine * std::sin(phase);
    }
  }
  return share * gain(angle_deg);
}

}  // namespace thermorig::labels
