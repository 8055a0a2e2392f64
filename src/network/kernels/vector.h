// SPDX-License-Identifier: MIT
#pragma once

// Included only by the kernels, which are compiled once an instruction set (THERMORIG_KERNELS is its name).
// No header of the standard library may come in here: an inline function compiled for AVX-512 could end up in
// everybody's program.

#if defined(__AVX512F__)
#define THERMORIG_VECTOR_BYTES 64
#elif defined(__AVX2__)
#define THERMORIG_VECTOR_BYTES 32
#else
#define THERMORIG_VECTOR_BYTES 16
#endif

#if defined(__clang__)
#define THERMORIG_UNROLL _Pragma("clang loop unroll(full)")
#else
#define THERMORIG_UNROLL _Pragma("GCC unroll 64")
#endif

namespace thermorig::network::THERMORIG_KERNELS {

/// As many floats as one register holds, and the same without alignment.
using Vector = float __attribute__((vector_size(THERMORIG_VECTOR_BYTES), may_alias));
// A typedef: in an alias declaration Clang would forget the alignment.
typedef float LooseVector __attribute__((vector_size(THERMORIG_VECTOR_BYTES), may_alias, aligned(4)));
inline constexpr int lanes = THERMORIG_VECTOR_BYTES / 4;

}  // namespace thermorig::network::THERMORIG_KERNELS
