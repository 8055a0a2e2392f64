// SPDX-License-Identifier: MIT
#pragma once

#include <stdint.h>

#include "vector.h"

#if defined(__F16C__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
#endif

// Floats and IEEE 754 halves between memory and registers; halves by the machine's instruction, or in
// software where it has none. Static: an inline function of an instruction set must not be merged with
// anybody's.

namespace thermorig::network::THERMORIG_KERNELS {

static inline Vector load(const float* floats) {
  return *reinterpret_cast<const LooseVector*>(floats);
}
static inline void store(float* floats, Vector v) {
  *reinterpret_cast<LooseVector*>(floats) = v;
}

/// The value in every lane. Not plus 0, which would turn -0 around and so remain an addition.
static inline Vector broadcast(float value) {
  return value - Vector{};
}

inline constexpr float largest_half = 65504.0F;

#if defined(__AVX512F__)

static inline Vector load(const uint16_t* halves) {
  return _mm512_cvtph_ps(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(halves)));
}
static inline void store(uint16_t* halves, Vector v) {
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(halves), _mm512_cvtps_ph(v, _MM_FROUND_TO_NEAREST_INT));
}

#elif defined(__F16C__)

static inline Vector load(const uint16_t* halves) {
  return _mm256_cvtph_ps(_mm_loadu_si128(reinterpret_cast<const __m128i*>(halves)));
}
static inline void store(uint16_t* halves, Vector v) {
  _mm_storeu_si128(reinterpret_cast<__m128i*>(halves), _mm256_cvtps_ph(v, _MM_FROUND_TO_NEAREST_INT));
}

#elif defined(__aarch64__)

static inline Vector load(const uint16_t* halves) {
  return vcvt_f32_f16(vreinterpret_f16_u16(vld1_u16(halves)));
}
static inline void store(uint16_t* halves, Vector v) {
  vst1_u16(halves, vreinterpret_u16_f16(vcvt_f16_f32(v)));
}

#else

using Bits = uint32_t __attribute__((vector_size(THERMORIG_VECTOR_BYTES)));
using Halves = uint16_t __attribute__((vector_size(THERMORIG_VECTOR_BYTES / 2)));
typedef uint16_t LooseHalves __attribute__((vector_size(THERMORIG_VECTOR_BYTES / 2), may_alias, aligned(2)));

/// Exponent and mantissa in a float's place are the value over 2^112, also where the half is subnormal.
static inline Vector load(const uint16_t* halves) {
  const Bits bits = __builtin_convertvector(Halves(*reinterpret_cast<const LooseHalves*>(halves)), Bits);
  const Vector magnitude = reinterpret_cast<Vector>((bits & 0x7FFFU) << 13U) * 0x1p112F;
  return reinterpret_cast<Vector>(reinterpret_cast<Bits>(magnitude) | (bits & 0x8000U) << 16U);
}

/// Adding a number whose last bit is worth as much as the half's rounds to nearest even.
static inline uint16_t half_of(float value) {
  uint32_t bits;
  __builtin_memcpy(&bits, &value, sizeof bits);
  const uint32_t sign = bits >> 16U & 0x8000U;
  const float magnitude = __builtin_fabsf(value);
  uint32_t exponent = (bits >> 23U & 0xFFU);
  if (exponent < 113) exponent = 113;  // below 2^-14 halves are evenly spaced
  const uint32_t magic_bits = (exponent + 13) << 23U;
  float magic;
  __builtin_memcpy(&magic, &magic_bits, sizeof magic);
  const float sum = magnitude + magic;  // ulp 2^(exponent - 10)
  uint32_t sum_bits;
  __builtin_memcpy(&sum_bits, &sum, sizeof sum_bits);
  const uint32_t steps = sum_bits - magic_bits;  // magnitude in units of the half's last bit
  return static_cast<uint16_t>(sign | (((exponent - 113) << 10U) + steps));
}
static inline void store(uint16_t* halves, Vector v) {
  for (int lane = 0; lane < lanes; ++lane) halves[lane] = half_of(v[lane]);
}

#endif

}  // namespace thermorig::network::THERMORIG_KERNELS
