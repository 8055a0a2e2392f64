// SPDX-License-Identifier: MIT
#pragma once

#include "training_vector.h"

namespace thermorig::network::THERMORIG_KERNELS {

/// Of the 2x2 blocks of `run` lanes in two rows, exchanges the two beside the diagonal.
template <int run, int... lane>
static inline void exchange(Vector& a, Vector& b, Lanes<lane...>) {
  const Vector first = __builtin_shufflevector(a, b, (lane & run ? lanes + (lane ^ run) : lane)...);
  b = __builtin_shufflevector(a, b, (lane & run ? lanes + lane : lane ^ run)...);
  a = first;
}

/// Transposes `lanes` rows: first halves of them, then quarters, down to single numbers.
template <int run>
static inline void transpose_rows(Vector (&rows)[lanes]) {
  THERMORIG_UNROLL
  for (int i = 0; i < lanes; ++i)
    if (!(i & run)) exchange<run>(rows[i], rows[i + run], LanesTo<lanes>::All());
  if constexpr (run > 1) transpose_rows<run / 2>(rows);
}

/// 32 x 32 numbers: `to` gets the first `count` columns of `from` as its rows.
static inline void transpose(const float* from, float* to, int count) {
  for (int left = 0; left < count; left += lanes) {
    for (int top = 0; top < cell; top += lanes) {
      Vector rows[lanes];
      THERMORIG_UNROLL
      for (int i = 0; i < lanes; ++i) rows[i] = load(from + (top + i) * cell + left);
      transpose_rows<lanes / 2>(rows);
      THERMORIG_UNROLL
      for (int i = 0; i < lanes; ++i)
        if (left + i < count) store(to + (left + i) * cell + top, rows[i]);
    }
  }
}

}  // namespace thermorig::network::THERMORIG_KERNELS
