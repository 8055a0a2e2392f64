// SPDX-License-Identifier: MIT
#include "thermorig/network/instruction_set.h"

namespace thermorig::network {

std::string_view name_of(InstructionSet set) {
  switch (set) {
    case InstructionSet::avx2:
      return "AVX2";
    case InstructionSet::avx512:
      return "AVX-512";
    case InstructionSet::baseline:
      break;
  }
  return "baseline";
}

std::vector<InstructionSet> instruction_sets() {
  std::vector<InstructionSet> sets{InstructionSet::baseline};
#ifdef THERMORIG_X86_64_KERNELS
  if (__builtin_cpu_supports("x86-64-v3")) sets.push_back(InstructionSet::avx2);
  if (__builtin_cpu_supports("x86-64-v4")) sets.push_back(InstructionSet::avx512);
#endif
  return sets;
}

InstructionSet best_instruction_set() {
  return instruction_sets().back();
}

}  // namespace thermorig::network
