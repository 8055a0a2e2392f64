// SPDX-License-Identifier: MIT
#pragma once

#include "training_vector.h"

namespace thermorig::network::THERMORIG_KERNELS {

/// first / (sqrt(second) + epsilon), within 2 units in the last place where only estimates of the roots are
/// fast. `second` is kept above 0, far below where it could matter beside epsilon.
static inline Vector adam_direction(Vector first, Vector second, float epsilon) {
  Vector root;
  for (int i = 0; i < lanes; ++i) root[i] = __builtin_sqrtf(second[i]);
  return first / (root + epsilon);
}

/// One vector of weights, see AdamStep.
static inline void adam_at(const AdamStep& step, Vector gradient, float* weights, float* first_moment,
                           float* second_moment) {
  Vector first = load(first_moment), second = load(second_moment);
  first += step.one_minus_beta1 * (gradient - first);
  second += step.one_minus_beta2 * (gradient * gradient - second);
  store(first_moment, first);
  store(second_moment, second);
  store(weights, load(weights) - step.rate * adam_direction(first, second, step.epsilon));
}

}  // namespace thermorig::network::THERMORIG_KERNELS
