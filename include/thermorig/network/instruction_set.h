// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>
#include <vector>

namespace thermorig::network {

/// For which kernels were built. `baseline` is what every machine of the architecture has (SSE2; on AArch64
/// NEON).
enum class InstructionSet : unsigned char { baseline, avx2, avx512 };

std::string_view name_of(InstructionSet set);

/// Those that this machine can run and this program was built with, the fastest last.
std::vector<InstructionSet> instruction_sets();

/// The fastest of them.
InstructionSet best_instruction_set();

}  // namespace thermorig::network
