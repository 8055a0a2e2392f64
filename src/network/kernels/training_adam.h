// SPDX-License-Identifier: MIT
#pragma once

#include "training_vector.h"

namespace thermorig::network::THERMORIG_KERNELS {

#if defined(__AVX512F__)
static inline Vector inverse_root_estimate(Vector x) {
  return _mm512_maskz_rsqrt14_ps(0xFFFF, x);
}
static inline Vector inverse_estimate(Vector x) {
  return _mm512_maskz_rcp14_ps(0xFFFF, x);
}
#elif defined(__AVX2__)
static inline Vector inverse_root_estimate(Vector x) {
  return _mm256_rsqrt_ps(x);
}
static inline Vector inverse_estimate(Vector x) {
  return _mm256_rcp_ps(x);
}
#endif

/// One vector of weights, see AdamStep. A root and a division of a vector take as long as some forty
/// multiply-adds, as long as the gradient itself; where there are estimates of both reciprocals, one step of
/// Newton's brings each within a few units in the last place.
static inline void adam_at(const AdamStep& step, Vector gradient, float* weights, float* first_moment,
                           float* second_moment) {
  const Vector weight = load(weights);
  Vector first = load(first_moment), second = load(second_moment);
  first += step.one_minus_beta1 * (gradient - first);
  second += step.one_minus_beta2 * (gradient * gradient - second);
  store(first_moment, first);
  store(second_moment, second);
  // (sqrt(second) + epsilon) / rate, with the rate within the root
  constexpr float least = 1e-30F;  // nothing beside epsilon, but more than 0
  const Vector scaled = step.root_scale * second + least;
#if defined(__AVX2__)
  const Vector inverse = inverse_root_estimate(scaled);
  const Vector root = scaled * inverse;
  const Vector divisor = root * (3.0F - root * inverse) + step.divisor_least;
  const Vector part = inverse_estimate(divisor);
  store(weights, weight - first * part * (2.0F - divisor * part));
#else
  Vector root;
  for (int i = 0; i < lanes; ++i) root[i] = __builtin_sqrtf(scaled[i]);
  store(weights, weight - first / (2.0F * root + step.divisor_least));
#endif
}

}  // namespace thermorig::network::THERMORIG_KERNELS
