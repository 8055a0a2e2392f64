// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "thermorig/network/embedded/c_source.h"

namespace thermorig::embedded {

/// The file of constants: scaling, then layer by layer weights, scales and biases.
std::string weights_text(const model::Model& model, WeightKind kind);

/// Flash that they take.
std::size_t constant_bytes(const model::Model& model, WeightKind kind);

/// A number as C writes it, which reads back as the same float: shortest decimal. (Hexadecimal would be C99,
/// but C++ only since 2017.)
std::string float_text(float value);

}  // namespace thermorig::embedded
