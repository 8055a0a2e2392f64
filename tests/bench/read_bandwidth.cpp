// SPDX-License-Identifier: MIT
#include "read_bandwidth.h"

#include <benchmark/benchmark.h>

namespace {

using Vector4 = float __attribute__((vector_size(16), may_alias, aligned(4)));
using Vector16 = float __attribute__((vector_size(64), may_alias, aligned(4)));

// A macro, because a function template cannot be given an instruction set and still be inlined.
#define THERMORIG_READ(Vector)                                            \
  Vector sum[8] = {};                                                     \
  constexpr std::size_t lanes = sizeof(Vector) / sizeof(float);           \
  for (std::size_t i = 0; i < size; i += 8 * lanes) {                     \
    _Pragma("GCC unroll 8") for (std::size_t v = 0; v < 8; ++v) sum[v] += \
        *reinterpret_cast<const Vector*>(values + i + lanes * v);         \
  }                                                                       \
  for (std::size_t v = 0; v < 8; ++v) benchmark::DoNotOptimize(sum[v])

#if defined(__x86_64__)
__attribute__((target("arch=x86-64-v4"))) void read16(const float* values, std::size_t size) {
  THERMORIG_READ(Vector16);
}
#endif
void read4(const float* values, std::size_t size) {
  THERMORIG_READ(Vector4);
}

}  // namespace

void read_burst(const std::vector<float>& values) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("x86-64-v4")) return read16(values.data(), values.size());
#endif
  read4(values.data(), values.size());
}
