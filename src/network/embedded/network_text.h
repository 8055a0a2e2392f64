// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace thermorig::embedded {

// The files of c99/: C but for words between two @, under the name thermorig_network.
extern const std::string_view network_h, network_c;

}  // namespace thermorig::embedded
