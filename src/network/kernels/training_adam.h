// SPDX-License-Identifier: MIT
#pragma once

#include "training_vector.h"

namespace thermorig::network::THERMORIG_KERNELS {

/// first / (2 * (sqrt(second) + epsilon)). A division and a root of a vector take as long as some forty
/// multiply-adds, as long as the gradient itself; where there are estimates of both reciprocals, one step of
/// Newton's brings each within a few units in the last place. Below `least` nothing differs beside epsilon.
static inline Vector adam_direction(Vector first, Vector second, float twice_epsilon) {
  constexpr float least = 1e-30F;
  second = larger(second, splat(least));
#if defined(__AVX2__)
#if defined(__AVX512F__)
  const auto estimate_root = [](Vector x) -> Vector { return _mm512_maskz_rsqrt14_ps(0xFFFF, x); };
  const auto estimate_part = [](Vector x) -> Vector { return _mm512_maskz_rcp14_ps(0xFFFF, x); };
#else
  const auto estimate_root = [](Vector x) -> Vector { return _mm256_rsqrt_ps(x); };
  const auto estimate_part = [](Vector x) -> Vector { return _mm256_rcp_ps(x); };
#endif
  const Vector inverse = estimate_root(second);
  const Vector root = second * inverse;
  const Vector twice = root * (3.0F - root * inverse) + twice_epsilon;
  const Vector part = estimate_part(twice);
  return first * part * (2.0F - twice * part);
#else
  Vector root;
  for (int i = 0; i < lanes; ++i) root[i] = __builtin_sqrtf(second[i]);
  return first / (2.0F * root + twice_epsilon);
#endif
}

/// One vector of weights, see AdamStep.
static inline void adam_at(const AdamStep& step, Vector gradient, float* weights, float* first_moment,
                           float* second_moment) {
  Vector first = load(first_moment), second = load(second_moment);
  first += step.one_minus_beta1 * (gradient - first);
  second += step.one_minus_beta2 * (gradient * gradient - second);
  store(first_moment, first);
  store(second_moment, second);
  store(weights, load(weights) - step.twice_rate * adam_direction(first, second, step.twice_epsilon));
}

}  // namespace thermorig::network::THERMORIG_KERNELS
