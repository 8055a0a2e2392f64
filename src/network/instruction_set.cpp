// SPDX-License-Identifier: MIT
#include "thermorig/network/instruction_set.h"

#include <array>

namespace thermorig::network {

namespace {

#ifdef THERMORIG_X86_64_KERNELS
bool runs_avx2() {
#ifdef __clang__  // version 14 knows features, no levels
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2");
#else
  return __builtin_cpu_supports("x86-64-v3");
#endif
}

bool runs_avx512() {
#ifdef __clang__
  return runs_avx2() && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512cd") &&
         __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
#else
  return __builtin_cpu_supports("x86-64-v4");
#endif
}
#endif

}  // namespace

std::string_view name_of(InstructionSet set) {
  static constexpr std::array names{"baseline", "AVX2", "AVX-512"};
  return names[static_cast<std::size_t>(set)];
}

std::vector<InstructionSet> instruction_sets() {
  std::vector<InstructionSet> sets{InstructionSet::baseline};
#ifdef THERMORIG_X86_64_KERNELS
  if (runs_avx2()) sets.push_back(InstructionSet::avx2);
  if (runs_avx512()) sets.push_back(InstructionSet::avx512);
#endif
  return sets;
}

InstructionSet best_instruction_set() {
  return instruction_sets().back();
}

}  // namespace thermorig::network
