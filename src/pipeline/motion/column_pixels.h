// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>

#include "half_view.h"

namespace thermorig::motion {

/// Of one column. Compilers unroll loops over so few before they see that they are vectors: hence Eigen.
using ColumnPixels = Eigen::Array<float, half_rows, 1>;
inline Eigen::Map<ColumnPixels> column_of(HalfPixels& pixels, std::size_t column) {
  return Eigen::Map<ColumnPixels>(&pixels[column * half_rows]);
}
inline Eigen::Map<const ColumnPixels> column_of(const HalfPixels& pixels, std::size_t column) {
  return Eigen::Map<const ColumnPixels>(&pixels[column * half_rows]);
}

}  // namespace thermorig::motion
