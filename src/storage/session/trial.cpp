// SPDX-License-Identifier: MIT
#include "trial.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include "thermorig/core/error.h"
#include "thermorig/core/printable.h"
#include "thermorig/io/spill/spill.h"
#include "thermorig/storage/session/trial.h"

namespace thermorig::session {

namespace {

#if defined(THERMORIG_IS_SANITIZED)
constexpr bool is_sanitized = true;
#else
constexpr bool is_sanitized = false;
#endif

constexpr std::uint64_t memory_bytes = 1ULL << 30U;  // for any session ...
constexpr std::uint64_t memory_per_byte = 24;        // ... and more for the rows of a large one
constexpr std::uint64_t least_cpu_s = 5;
constexpr std::uint64_t bytes_per_cpu_s = 1U << 18U;  // a slow computer reads a hundred times that
constexpr std::uint64_t wall_per_cpu = 12;            // a machine may be busy with other things
constexpr std::size_t answer_bytes_max = 1U << 16U;   // as much as a pipe holds
constexpr int read_well = 0, refused = 1;             // codes of the child

std::atomic<bool> is_on = false;

std::uint64_t cpu_limit_s(const StoredFile& file) {
  return least_cpu_s + file.size() / bytes_per_cpu_s;
}

void limit(__rlimit_resource_t resource, std::uint64_t most, std::uint64_t beyond = 0) {
  const rlimit both{most, most + beyond};
  // Where a limit is refused because a lower one holds already, that one serves.
  ::setrlimit(resource, &both);
}

/// Of this process, which the child has as well.
std::uint64_t address_bytes() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

void limit_resources(const StoredFile& file) {
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_FSIZE, 0);
  limit(RLIMIT_NPROC, 0);
  limit(RLIMIT_CPU, cpu_limit_s(file), 1);  // first SIGXCPU, which says why
  if (!is_sanitized) limit(RLIMIT_AS, address_bytes() + memory_bytes + memory_per_byte * file.size());
  ::alarm(static_cast<unsigned>(cpu_limit_s(file) * wall_per_cpu));
}

/// From here on the kernel refuses this process (EPERM) every call but those that reading what is open needs:
/// a C library that tries one more and can do without it must not make a sound file look hostile. Where the
/// kernel has no such filter the other limits hold.
void filter_calls(int answer) {
  const scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(EPERM));
  if (filter == nullptr) return;
  for (const int call : {SCMP_SYS(read), SCMP_SYS(pread64), SCMP_SYS(lseek), SCMP_SYS(brk), SCMP_SYS(munmap),
                         SCMP_SYS(mremap), SCMP_SYS(madvise), SCMP_SYS(futex), SCMP_SYS(clock_gettime),
                         SCMP_SYS(gettimeofday), SCMP_SYS(getrandom), SCMP_SYS(restart_syscall),
                         SCMP_SYS(rt_sigreturn), SCMP_SYS(exit), SCMP_SYS(exit_group)})
    seccomp_rule_add(filter, SCMP_ACT_ALLOW, call, 0);
  for (const int call : {SCMP_SYS(mmap), SCMP_SYS(mprotect)})
    seccomp_rule_add(filter, SCMP_ACT_ALLOW, call, 1, SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0));
  seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(write), 1,
                   SCMP_A0(SCMP_CMP_EQ, static_cast<scmp_datum_t>(answer)));
  // A sanitizer asks by a pipe whether an object can be read, waits for its own threads, and reports.
  if (is_sanitized)
    for (const int call :
         {SCMP_SYS(pipe), SCMP_SYS(pipe2), SCMP_SYS(write), SCMP_SYS(writev), SCMP_SYS(close),
          SCMP_SYS(getpid), SCMP_SYS(gettid), SCMP_SYS(sched_yield), SCMP_SYS(clock_nanosleep),
          SCMP_SYS(rt_sigaction), SCMP_SYS(rt_sigprocmask), SCMP_SYS(sigaltstack)})
      seccomp_rule_add(filter, SCMP_ACT_ALLOW, call, 0);
  seccomp_load(filter);
}

/// A Ctrl-C is the program's: the child ends with it. What limits time must end the child. All signals are
/// blocked when it is born.
void take_signals() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP}) std::signal(signal, SIG_IGN);
  for (const int signal : {SIGXCPU, SIGALRM}) std::signal(signal, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
}

[[noreturn]] void be_child(int answer, const StoredFile& file, const std::function<void()>& read) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  take_signals();
  spill::arrays_in_memory();
  limit_resources(file);
  filter_calls(answer);
  try {
    read();
    ::_exit(read_well);
  } catch (const Error& error) {
    std::string text = std::to_string(static_cast<int>(error.code())) + '\0';
    for (const auto& part : {error.what_happened(), error.where(), error.advice()}) text += part + '\0';
    if (::write(answer, text.data(), text.size()) == static_cast<ssize_t>(text.size())) ::_exit(refused);
  } catch (const std::exception&) {  // too little memory, for one
  }
  ::_exit(refused + 1);
}

/// The child may be in the file's hands: its words are shown as text, and its code is one that reading has.
[[noreturn]] void refuse_as_told(const std::string& text, const StoredFile& file) {
  std::istringstream lines(text);
  std::array<std::string, 4> parts;
  for (std::string& part : parts)
    if (!std::getline(lines, part, '\0'))
      refuse(file.path(), "is damaged or hostile: its reader did not say why");
  auto code = ExitCode::not_a_session;
  for (const ExitCode other : {ExitCode::failed, ExitCode::storage})
    if (parts[0] == std::to_string(static_cast<int>(other))) code = other;
  const std::string path = file.path().string();
  throw Error(code, printable(parts[1]), parts[2] == path ? path : printable(parts[2]), printable(parts[3]));
}

std::string end_of(int status) {
  if (!WIFSIGNALED(status)) return "ended by itself";
  const char* const name = ::sigabbrev_np(WTERMSIG(status));
  return fmt::format("was ended by SIG{}", name == nullptr ? std::to_string(WTERMSIG(status)) : name);
}

/// The memory of a sanitizer, other than that of the C library, is of no use to the child of a program with
/// several threads.
bool can_fork() {
  if (!is_sanitized) return true;
  const std::filesystem::directory_iterator threads("/proc/self/task");
  return std::distance(begin(threads), end(threads)) == 1;
}

[[noreturn]] void no_child_possible() {
  throw Error(ExitCode::failed, std::string("no process can be made to try files: ") + std::strerror(errno),
              "", "close other programs");
}

}  // namespace

void try_sessions_first() {
  std::signal(SIGCHLD, SIG_DFL);  // who was told to ignore it never learns how a child ended
  is_on = true;
}

bool are_sessions_tried() {
  return is_on;
}

Trial::Trial(const StoredFile& file, const std::function<void()>& read) : file_(file) {
  if (!can_fork()) return;
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) no_child_possible();
  answer_ = files::Descriptor(ends[0]);
  const files::Descriptor to_write(ends[1]);
  sigset_t all, before;
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  child_ = ::fork();
  if (child_ == 0) be_child(to_write.get(), file, read);
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  if (child_ < 0) no_child_possible();
}

Trial::~Trial() {
  if (child_ < 0) return;
  ::kill(child_, SIGKILL);
  end();
}

void Trial::end() {
  pid_t ended = -1;
  do ended = ::waitpid(child_, &status_, 0);
  while (ended < 0 && errno == EINTR);
  if (ended < 0) status_ = SIGKILL;  // nobody knows
  child_ = -1;
}

void Trial::require_good() {
  if (child_ < 0) return;
  std::string text(answer_bytes_max, '\0');
  ssize_t size = 0;
  do size = ::read(answer_.get(), text.data(), text.size());  // one write, or the end of the child
  while (size < 0 && errno == EINTR);
  text.resize(size < 0 ? 0 : static_cast<std::size_t>(size));
  end();
  if (WIFEXITED(status_) && WEXITSTATUS(status_) == read_well) return;
  if (WIFEXITED(status_) && WEXITSTATUS(status_) == refused) refuse_as_told(text, file_);
  const int signal = WIFSIGNALED(status_) ? WTERMSIG(status_) : 0;
  if (signal == SIGXCPU || signal == SIGALRM)
    refuse(file_.path(), fmt::format("is damaged or hostile, or this computer too busy: after {} s{} the "
                                     "process that tried to read it first was not done",
                                     cpu_limit_s(file_) * (signal == SIGALRM ? wall_per_cpu : 1),
                                     signal == SIGXCPU ? " of processor time" : ""));
  refuse(file_.path(), "is damaged or hostile: the process that tried to read it first " + end_of(status_));
}

}  // namespace thermorig::session
