// SPDX-License-Identifier: MIT
// The filter is a program for the kernel's packet filter, written out by hand: see seccomp(2). A call that is
// not on the list fails with EPERM instead of killing: a C library newer than this list, which tries one more
// call and can do without it, must not make a sound file look hostile. Whoever means harm gains nothing by
// it.
#include "call_filter.h"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sanitized.h"

namespace thermorig::sandbox {

namespace {

#if defined(__x86_64__)
constexpr std::uint32_t own_architecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__) && defined(__AARCH64EL__)
constexpr std::uint32_t own_architecture = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t own_architecture = 0;  // the numbers of its calls were never looked at
#endif

constexpr std::uint32_t other_numbering = 0x40000000;  // x86-64: calls of the x32 ABI; no call is so high

constexpr std::array allowed{__NR_brk,
                             __NR_munmap,
                             __NR_mremap,
                             __NR_madvise,
                             __NR_futex,  // memory and locks
                             __NR_clock_gettime,
                             __NR_gettimeofday,
                             __NR_getrandom,  // the C library's own
                             __NR_restart_syscall,
                             __NR_write,
                             __NR_close,
                             __NR_rt_sigreturn,  // from the handlers of time, which were set up before
                             __NR_exit,
                             __NR_exit_group};

/// A sanitizer asks by a pipe whether an object can be read, waits for its own threads, and reports a crash.
/// Elsewhere nobody may handle or block a signal: the alarm would have no end.
constexpr std::array allowed_to_sanitizers {
#if defined(__NR_pipe)
  __NR_pipe,
#endif
      __NR_pipe2, __NR_writev, __NR_getpid, __NR_gettid, __NR_sched_yield, __NR_clock_nanosleep,
      __NR_rt_sigaction, __NR_rt_sigprocmask, __NR_sigaltstack
};

/// Memory of these may not be executable.
constexpr std::array allowed_without_execution{__NR_mmap, __NR_mprotect};

using Program = std::vector<sock_filter>;

constexpr std::uint32_t refused_call = SECCOMP_RET_ERRNO | EPERM;

void load(Program& program, std::size_t offset) {
  program.push_back(BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset)));
}

void answer(Program& program, std::uint32_t what) {
  program.push_back(BPF_STMT(BPF_RET | BPF_K, what));
}

/// The next `instructions` are passed over unless what was loaded compares so with `value`.
void unless(Program& program, std::uint16_t comparison, std::uint32_t value, std::uint8_t instructions) {
  program.push_back(
      BPF_JUMP(static_cast<std::uint16_t>(BPF_JMP | comparison | BPF_K), value, 0, instructions));
}

void allow(Program& program, int call) {
  unless(program, BPF_JEQ, static_cast<std::uint32_t>(call), 1);
  answer(program, SECCOMP_RET_ALLOW);
}

/// The third argument is what the memory may be used for; of its two words the first has the bits, on
/// processors that store the low word first.
void allow_without_execution(Program& program, int call) {
  unless(program, BPF_JEQ, static_cast<std::uint32_t>(call), 4);
  load(program, offsetof(seccomp_data, args) + 2 * sizeof(std::uint64_t));
  unless(program, BPF_JSET, PROT_EXEC, 1);
  answer(program, refused_call);
  answer(program, SECCOMP_RET_ALLOW);
}

Program reading_only() {
  Program program;
  load(program, offsetof(seccomp_data, arch));
  program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, own_architecture, 1, 0));
  answer(program, SECCOMP_RET_KILL_PROCESS);
  load(program, offsetof(seccomp_data, nr));
  unless(program, BPF_JGE, other_numbering, 1);
  answer(program, SECCOMP_RET_KILL_PROCESS);
  for (const int call : allowed) allow(program, call);
  if (is_sanitized)
    for (const int call : allowed_to_sanitizers) allow(program, call);
  for (const int call : allowed_without_execution) allow_without_execution(program, call);
  answer(program, refused_call);
  return program;
}

}  // namespace

void filter_calls() {
  if (own_architecture == 0) return;
  Program program = reading_only();
  const sock_fprog filter{.len = static_cast<unsigned short>(program.size()), .filter = program.data()};
  // Refused where the kernel was built without it.
  ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter, 0, 0);
}

}  // namespace thermorig::sandbox
