// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>

#include "half_view.h"

namespace thermorig::motion {

/// Of one column. Compilers unroll loops over so few before they see that they are vectors: hence Eigen.
using ColumnPixels = Eigen::Array<float, half_rows, 1>;
using ColumnOf = Eigen::Map<ColumnPixels, Eigen::Aligned16>;
using ConstColumnOf = Eigen::Map<const ColumnPixels, Eigen::Aligned16>;
inline ColumnOf column_of(HalfPixels& pixels, std::size_t column) {
  return ColumnOf(&pixels[column * half_rows]);
}
inline ConstColumnOf column_of(const HalfPixels& pixels, std::size_t column) {
  return ConstColumnOf(&pixels[column * half_rows]);
}

}  // namespace thermorig::motion
