// SPDX-License-Identifier: MIT
#pragma once

namespace thermorig::network {

/// Below and above these gains (Kg) the gate of a fusion network gives (almost) all to one side.
inline constexpr double closed_gate = 0.02, open_gate = 0.98;

}  // namespace thermorig::network
