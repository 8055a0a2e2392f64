// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "thermorig/network/embedded/c_source.h"

namespace thermorig::embedded {

// Lines of a C comment, each begun with " * " and none with a line break at its end.

/// What every file says of its model.
std::string facts_text(const model::Model& model, WeightKind kind);

/// Which recordings it was trained on.
std::string data_text(const model::Provenance& provenance);

}  // namespace thermorig::embedded
