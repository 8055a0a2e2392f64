// SPDX-License-Identifier: MIT
#pragma once

#include "training_kernels.h"
#include "vector.h"

#if defined(__AVX2__)
#include <immintrin.h>
#endif

// Loops that must stay loops: unrolled, the compiler would keep the loads of all turns in registers, and
// spill.
#if defined(__clang__)
#define THERMORIG_KEEP_LOOP _Pragma("clang loop unroll(disable)")
#else
#define THERMORIG_KEEP_LOOP _Pragma("GCC unroll 1")
#endif

// Tiles that must stay functions: put together, they would compete for the registers.
#define THERMORIG_TILE __attribute__((noinline))

namespace thermorig::network::THERMORIG_KERNELS {

using Mask = int __attribute__((vector_size(THERMORIG_VECTOR_BYTES), may_alias));

inline constexpr int vectors = cell / lanes;  // of a cell

// How many accumulators a tile may have: as many as hide the latency of a multiply-add and leave registers
// for its operands. AVX-512 and AArch64 have 32 registers, the others 16.
#if defined(__AVX512F__) || defined(__aarch64__)
inline constexpr int accumulators = 24;
#else
inline constexpr int accumulators = 12;
#endif

static inline Vector load(const float* at) {
  return *reinterpret_cast<const Vector*>(at);
}

static inline void store(float* at, Vector value) {
  *reinterpret_cast<Vector*>(at) = value;
}

template <int rows, int columns>
static inline void load_tile(Vector (&tile)[rows][columns], const float* from, long row, long column) {
  THERMORIG_UNROLL
  for (int r = 0; r < rows; ++r) {
    THERMORIG_UNROLL
    for (int c = 0; c < columns; ++c) tile[r][c] = load(from + r * row + c * column);
  }
}

template <int rows, int columns>
static inline void store_tile(const Vector (&tile)[rows][columns], float* to, long row, long column) {
  THERMORIG_UNROLL
  for (int r = 0; r < rows; ++r) {
    THERMORIG_UNROLL
    for (int c = 0; c < columns; ++c) store(to + r * row + c * column, tile[r][c]);
  }
}

static inline Vector splat(float value) {
  return value - Vector{};
}

/// The larger of each two. The machine's instruction, which compilers do not find by themselves. With a mask
/// of all lanes, here and below: without, GCC 12 warns of its own header.
static inline Vector larger(Vector a, Vector b) {
#if defined(__AVX512F__)
  return _mm512_maskz_max_ps(0xFFFF, a, b);
#elif defined(__AVX2__)
  return _mm256_max_ps(a, b);
#else
  return a > b ? a : b;
#endif
}

static inline Vector relu(Vector x) {
  return larger(x, Vector{});
}

/// x where y, the output of a ReLU, let it through.
static inline Vector through_relu(Vector x, Vector y) {
  return y > 0.0F ? x : Vector{};
}

template <int... lane>
struct Lanes {};
template <int count, int... lane>
struct LanesTo : LanesTo<count - 1, count - 1, lane...> {};
template <int... lane>
struct LanesTo<0, lane...> {
  using All = Lanes<lane...>;
};

template <int distance, int... lane>
static inline Vector moved(Vector x, Lanes<lane...>) {
  return __builtin_shufflevector(x, x, (lane ^ distance)...);
}

template <int distance = lanes / 2>
static inline float sum_of(Vector x) {
  x += moved<distance>(x, LanesTo<lanes>::All());
  if constexpr (distance > 1) return sum_of<distance / 2>(x);
  return x[0];
}

/// The sum over the samples of a cell.
static inline float sum_of_cell(const float* at) {
  Vector sum = load(at);
  THERMORIG_UNROLL
  for (int v = 1; v < vectors; ++v) sum += load(at + v * lanes);
  return sum_of(sum);
}

}  // namespace thermorig::network::THERMORIG_KERNELS
