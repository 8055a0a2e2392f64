// SPDX-License-Identifier: MIT
#pragma once

namespace thermorig::network {

/// While it lives, this thread takes numbers below 1e-38 for 0. Moments of weights that get no gradient any
/// more fade down to there, where a processor needs a hundred times as long for each.
class FlushDenormals {
 public:
#if defined(__SSE2__)
  FlushDenormals() : before_(__builtin_ia32_stmxcsr()) {
    __builtin_ia32_ldmxcsr(before_ | 0x8040U);
  }
  ~FlushDenormals() {
    __builtin_ia32_ldmxcsr(before_);
  }
#elif defined(__aarch64__)
  FlushDenormals() {
    asm volatile("mrs %0, fpcr" : "=r"(before_));
    asm volatile("msr fpcr, %0" ::"r"(before_ | (1UL << 24U)));
  }
  ~FlushDenormals() {
    asm volatile("msr fpcr, %0" ::"r"(before_));
  }
#else
  FlushDenormals() {}
#endif
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
#if defined(__SSE2__)
  unsigned before_;
#elif defined(__aarch64__)
  unsigned long before_ = 0;
#endif
};

}  // namespace thermorig::network
