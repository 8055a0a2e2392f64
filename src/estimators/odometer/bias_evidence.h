// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "bias_search.h"

namespace thermorig::odometer {

/// What searches for the gyro's bias have said so far, of bias and scale together. A single one is often
/// wrong, and what the scale is off, times the speed, moves the bias that it names. But wrong ones differ
/// from search to search, and the right one comes again: likelihoods add up.
class BiasEvidence {
 public:
  explicit BiasEvidence(const Priors& priors);

  /// Of halves that no other search has looked at.
  void add(const BiasSearch::Curve& curve);
  /// What was expected, with a better bias and scale. Nothing: searches do not name them clearly yet.
  const std::optional<Priors>& found() const { return found_; }
  void clear();

 private:
  struct Offset {  // from what was expected
    double bias_dps = 0.0, scale = 0.0;
  };
  Offset offset(std::size_t place) const;
  std::size_t size() const;
  void begin(const BiasSearch::Curve& curve);
  void weigh(const BiasSearch::Curve& curve);
  void find();

  Priors priors_;
  std::size_t biases_ = 0;  // none: nothing was added
  double step_dps_ = 0.0;
  std::vector<double> logs_;      // of likelihoods: biases, scale after scale
  std::vector<double> of_curve_;  // the same of the newest search, a bias each
  std::optional<Priors> found_;
};

}  // namespace thermorig::odometer
