// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "thermorig/network/model/model.h"

namespace thermorig::embedded {

/// A file to be written.
struct SourceFile {
  std::string name;
  std::string text;
};

enum class WeightKind : unsigned char { float32, int8 };

/// A network as C99 for small boards: no malloc, no file, no library but <math.h>'s expf; one function from
/// pixels in degrees Celsius and a gyro mean in deg/s to speeds in deg/s and Kg.
struct CSource {
  std::vector<SourceFile> files;   // <name>.h, <name>.c, <name>_weights.h
  std::size_t constant_bytes = 0;  // weights and scales: flash
  std::size_t working_bytes = 0;   // the caller's work area: RAM
};

/// `name`: prefix of files and symbols, a C identifier. int8: convolutions and the heads' first layers
/// symmetric in 8 bits, a scale for each output row or filter; the small layers after them stay float32.
/// Throws Error(bad_usage) if `name` is no identifier.
CSource c_source(const model::Model& model, WeightKind kind, const std::string& name);

}  // namespace thermorig::embedded
