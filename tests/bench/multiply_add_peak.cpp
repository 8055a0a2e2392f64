// SPDX-License-Identifier: MIT
#include "multiply_add_peak.h"

#include <benchmark/benchmark.h>

namespace {

using thermorig::network::InstructionSet;

using Vector4 = float __attribute__((vector_size(16)));
using Vector8 = float __attribute__((vector_size(32)));
using Vector16 = float __attribute__((vector_size(64)));

constexpr int turns = 30'000;
constexpr int sums = 12;  // latency 4 or 5, two a clock; fits 16 registers

// A macro, because a function template cannot be given an instruction set and still be inlined.
#define THERMORIG_BURST(Vector)                                                                        \
  Vector sum[sums];                                                                                    \
  for (int i = 0; i < sums; ++i) sum[i] = 0.01F * float(i) - Vector{};                                 \
  Vector factor = 0.5F - Vector{}, term = 0.25F - Vector{};                                            \
  asm volatile("" : "+m"(factor), "+m"(term));                                                         \
  const Vector f = factor, t = term;                                                                   \
  for (int turn = 0; turn < turns; ++turn) {                                                           \
    _Pragma("GCC unroll 48") for (int i = 0; i < 4 * sums; ++i) sum[i % sums] = sum[i % sums] * f + t; \
  }                                                                                                    \
  for (int i = 0; i < sums; ++i) benchmark::DoNotOptimize(sum[i]);                                     \
  return 2.0 * turns * 4 * sums * (sizeof(Vector) / sizeof(float))

#if defined(__x86_64__)
__attribute__((target("arch=x86-64-v4"))) double burst16() {
  THERMORIG_BURST(Vector16);
}
__attribute__((target("arch=x86-64-v3"))) double burst8() {
  THERMORIG_BURST(Vector8);
}
#endif
double burst4() {
  THERMORIG_BURST(Vector4);
}

}  // namespace

double multiply_add_burst([[maybe_unused]] InstructionSet set) {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) return burst16();
  if (set == InstructionSet::avx2) return burst8();
#endif
  return burst4();
}
