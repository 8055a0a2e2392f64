// SPDX-License-Identifier: MIT
// Files that were made to harm who reads them: a child reads first, and dies in our place.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>
#include <iostream>
#include <random>
#include <tuple>
#include <utility>

#include "equality.h"
#include "storage/sandbox/child_limits.h"
#include "storage/sandbox/refusal_text.h"
#include "storage/sandbox/sanitized.h"
#include "storage/session/tasks.h"
#include "synthetic_session.h"
#include "temporary_folder.h"
#include "thermorig/core/error.h"
#include "thermorig/storage/sandbox/sandbox.h"
#include "thermorig/storage/session/session.h"
#include "thermorig/storage/session/trial.h"

namespace thermorig::session {
namespace {

using Bytes = std::vector<char>;

/// Runs `body` in a process of its own, in which files are tried first; its status as waitpid() gives it.
template <typename Body>
int in_a_program(Body body) {
  const pid_t child = ::fork();
  if (child == 0) {
    try_sessions_first();
    ::alarm(3600);
    ::_exit(body());
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return status;
}

/// One that is refused ends with 8, as the program does; `died` counts the refusals that a child's death
/// made.
int code_of_reading(const std::filesystem::path& path, const Session& truth, int& died) {
  try {
    return difference(truth, read_session(path)).empty() ? 0 : 100;
  } catch (const Error& error) {
    if (error.what_happened().find("hostile") != std::string::npos) ++died;
    return static_cast<int>(error.code());
  }
}

/// Read, refused, or given up on.
bool is_an_ordinary_end(ExitCode code) {
  return code == ExitCode::ok || code == ExitCode::not_a_session || code == ExitCode::failed;
}

class HostileSession : public InTemporaryFolder {
 protected:
  void SetUp() override {
    InTemporaryFolder::SetUp();
    write_session(path("whole.h5"), truth_);
    whole_ = read_file(path("whole.h5"));
  }

  /// Where bytes matter most to libhdf5: around the names of its own structures.
  std::vector<std::size_t> structures() const {
    std::vector<std::size_t> found;
    for (const std::string name : {"TREE", "SNOD", "HEAP", "OHDR", "OCHK", "GCOL", "BTHD", "FRHP", "BTLF"})
      for (auto at = std::search(whole_.begin(), whole_.end(), name.begin(), name.end()); at != whole_.end();
           at = std::search(at + 1, whole_.end(), name.begin(), name.end()))
        found.push_back(static_cast<std::size_t>(at - whole_.begin()));
    return found;
  }

  /// Bytes flipped anywhere or beside a structure, numbers set to extremes, an end cut off, pieces moved.
  Bytes mutant(std::mt19937& random, const std::vector<std::size_t>& places) const {
    Bytes bytes = whole_;
    const auto anywhere = [&] { return random() % bytes.size(); };
    const auto beside = [&] {
      return std::min(places[random() % places.size()] + random() % 96, bytes.size() - 1);
    };
    for (unsigned i = 0, n = 1 + random() % 4; i < n; ++i) {
      switch (random() % 6) {
        case 0:
          bytes[anywhere()] ^= static_cast<char>(1 + random() % 255);
          break;
        case 1:
        case 2:
          bytes[beside()] ^= static_cast<char>(1 + random() % 255);
          break;
        case 3: {
          const std::size_t at = std::min(beside(), bytes.size() - 8);
          std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), 1 + random() % 8,
                      random() % 2 == 0 ? '\0' : '\xff');
          break;
        }
        case 4: {
          const std::size_t size = std::min<std::size_t>(1 + random() % 256, bytes.size() / 4);
          const std::size_t from = random() % (bytes.size() - size), to = random() % (bytes.size() - size);
          std::memmove(&bytes[to], &bytes[from], size);
          break;
        }
        default:
          if (random() % 8 == 0) bytes.resize(bytes.size() / 2 + random() % (bytes.size() / 2));
      }
    }
    return bytes;
  }

  const Session truth_ = synthetic_live_session(12);
  Bytes whole_;
};

TEST_F(HostileSession, IsReadWhereNothingIsWrong) {
  int died = 0;
  EXPECT_EQ(in_a_program([&] { return code_of_reading(path("whole.h5"), truth_, died); }), 0);
}

TEST_F(HostileSession, IsTheVeryCopyThatWasTried) {
  const sandbox::SealedCopy copy(path("whole.h5"));
  write_file(path("whole.h5"), {'x'});
  EXPECT_EQ(difference(truth_, read_session(copy)), "");
  EXPECT_NE(::pwrite(copy.fd(), "x", 1, 0), 1);
}

TEST_F(HostileSession, IsReadAndTriedUnderALimitOfFileSizesAsWell) {
  int died = 0;
  const int status = in_a_program([&] {
    rlimit before{};
    ::getrlimit(RLIMIT_FSIZE, &before);
    const rlimit limit{1000, before.rlim_max};  // `ulimit -f`: smaller than any session
    ::setrlimit(RLIMIT_FSIZE, &limit);
    const bool is_file = sandbox::SealedCopy(path("whole.h5")).fd() >= 0;
    const int code = code_of_reading(path("whole.h5"), truth_, died);
    ::setrlimit(RLIMIT_FSIZE, &before);
    return is_file ? 101 : code;
  });
  EXPECT_EQ(status, 0);
}

// Mutants ($THERMORIG_MUTANTS: how many), each read by a program that goes on: whatever libhdf5 does with
// them, it does to a child. Most where a sanitizer looks on.
TEST_F(HostileSession, NeverHarmsTheProgram) {
  const char* asked = std::getenv("THERMORIG_MUTANTS");
  const int usual = sandbox::is_sanitized ? 400 : 100;
  const int mutants = asked == nullptr ? usual : std::atoi(asked);
  const auto report = path("died");
  const int status = in_a_program([&] {
    std::mt19937 random(23);
    const auto places = structures();
    int died = 0, refused = 0;
    for (int i = 0; i < mutants; ++i) {
      write_file(path("mutant.h5"), mutant(random, places));
      const int code = code_of_reading(path("mutant.h5"), truth_, died);
      if (!is_an_ordinary_end(static_cast<ExitCode>(code))) return 1 + code;
      refused += code == 0 ? 0 : 1;
    }
    std::cout << mutants << " mutants: " << refused << " refused, " << died
              << " of them killed their reader or kept it busy" << std::endl;
    return refused > mutants / 4 ? 0 : 1;
  });
  EXPECT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

class Sandbox : public InTemporaryFolder {
 protected:
  template <typename Body>
  static int in_sandbox(
      Body body, void (*before)() = [] {}) {
    const pid_t child = ::fork();
    if (child == 0) {
      before();
      sandbox::enter(1000);
      ::_exit(body());
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return status;
  }
};

class Trial : public InTemporaryFolder {
 protected:
  template <typename Body>
  static sandbox::End answer_of_a_child(Body body) {
    std::array<int, 2> ends{};
    EXPECT_EQ(::pipe(ends.data()), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      sandbox::answer_when_time_is_up(ends[1]);
      body();
      ::_exit(1);
    }
    ::close(ends[1]);
    sandbox::End answer = sandbox::End::died;
    EXPECT_GE(::read(ends[0], &answer, sizeof answer), 0);
    ::close(ends[0]);
    ::waitpid(child, nullptr, 0);
    return answer;
  }
  static sandbox::End answer_of_a_child_that_gets(int signal) {
    return answer_of_a_child([signal] {
      sandbox::count_inflated(-sandbox::inflated_bytes());  // of what this process has read itself
      ::raise(signal);
    });
  }
};

TEST_F(Sandbox, EndsWhoeverIsBusyForTooLong) {
  const pid_t child = ::fork();
  if (child == 0) {
    rlimit shorter{1, 1};  // the limit that the sandbox sets would be higher, and is refused
    ::setrlimit(RLIMIT_CPU, &shorter);
    sandbox::enter(0);
    std::mt19937 busy;
    while (true) busy.discard(1'000'000);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status));
}

// Deflate shrinks up to a thousandfold: what takes long to read may be a small file.
TEST(TimeLimits, SufficeForAFileOfZerosOnASlowComputer) {
  constexpr std::uint64_t slow_bytes_per_s = 20'000'000;
  for (const std::uint64_t bytes :
       {std::uint64_t{100'000}, std::uint64_t{1'000'000}, std::uint64_t{4} << 30U}) {
    const sandbox::TimeLimits limits = sandbox::time_limits(bytes);
    const std::uint64_t inflated = 1000 * bytes;
    EXPECT_GE(limits.cpu_s + inflated / sandbox::inflated_bytes_per_cpu_s, inflated / slow_bytes_per_s);
    EXPECT_GE(limits.longest_cpu_s, limits.cpu_s + inflated / sandbox::inflated_bytes_per_cpu_s);
    EXPECT_GE(limits.wall_s, std::min<std::uint64_t>(10 * limits.longest_cpu_s, 86'400));
  }
}

TEST_F(Sandbox, TellsEverySecondBeyondTheFirstLimit) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    sandbox::enter(1000);
    for (char there = 'x';; there = 0)  // until it is killed: in there it may neither ask nor wait
      if (there != 0 && ::write(ends[1], &there, 1) != 1) ::_exit(1);
  }
  char there = 0;
  EXPECT_EQ(::read(ends[0], &there, 1), 1);
  rlimit cpu{};
  EXPECT_EQ(::prlimit(child, RLIMIT_CPU, nullptr, &cpu), 0);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  for (const int end : ends) ::close(end);
  const sandbox::TimeLimits limits = sandbox::time_limits(1000);
  EXPECT_EQ(cpu.rlim_cur, limits.cpu_s);
  EXPECT_EQ(cpu.rlim_max, limits.longest_cpu_s);
}

TEST_F(Sandbox, LetsAReaderGoOnThatWasTold) {
  static volatile std::sig_atomic_t told = 0;
  const auto wait_until_told = [] {
    while (told < 2) {
    }
    return 0;
  };
  const int status = in_sandbox(wait_until_told, [] {
    std::signal(SIGVTALRM, [](int) { told = told + 1; });
    const itimerval every_ms{{0, 1000}, {0, 1000}};  // what SIGXCPU would take seconds for
    ::setitimer(ITIMER_VIRTUAL, &every_ms, nullptr);
  });
  EXPECT_EQ(status, 0);
}

TEST_F(Trial, GoesOnAsLongAsItReadsData) {
  const auto end_after = [](int signals) {
    return answer_of_a_child([signals] {
      sandbox::count_inflated(2 * sandbox::inflated_bytes_per_cpu_s - sandbox::inflated_bytes());
      for (int i = 0; i < signals; ++i) ::raise(SIGXCPU);
    });
  };
  EXPECT_EQ(end_after(2), sandbox::End::died);  // it went on, and ended without an answer
  EXPECT_EQ(end_after(3), sandbox::End::no_cpu_time);
}

// The file may be sound, and the computer slow or busy: what is said then must not be that it is damaged.
TEST_F(Trial, NamesAlteredAttributesInTheChildAsWithoutOne) {
  write_session(path(), synthetic_session(2));
  std::vector<char> bytes = read_file(path());
  const std::string clock = "CLOCK_MONOTONIC";
  *(std::search(bytes.begin(), bytes.end(), clock.begin(), clock.end())) = 'X';
  write_file(path(), bytes);
  const std::vector<std::string> altered{"/sync@host_clock"};
  EXPECT_EQ(altered_attributes(sandbox::SealedCopy(path())), altered);
  EXPECT_EQ(in_a_program([&] { return altered_attributes(sandbox::SealedCopy(path())) == altered ? 0 : 1; }),
            0);
}

TEST_F(Trial, ThatRunsOutOfTimeSaysSoAndNothingOfTheFile) {
  write_session(path(), synthetic_session(2));
  const sandbox::SealedCopy copy(path());
  const std::tuple<int, sandbox::End, const char*> ends[] = {
      {SIGXCPU, sandbox::End::no_cpu_time, " s of processor time and a second for every 4 MiB of data in it"},
      {SIGALRM, sandbox::End::no_wall_time, " s"}};
  for (const auto& [signal, end, limit] : ends) {
    EXPECT_EQ(answer_of_a_child_that_gets(signal), end);
    try {
      sandbox::require_done({end, ""}, copy);
      ADD_FAILURE() << limit;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::failed);
      EXPECT_THAT(error.what_happened(), testing::StartsWith("could not be read within "));
      EXPECT_THAT(error.what_happened(), testing::EndsWith(limit));
    }
  }
}

TEST_F(Trial, ThatEndsWithoutAnAnswerMeansADamagedOrHostileFile) {
  write_session(path(), synthetic_session(2));
  const sandbox::SealedCopy copy(path());
  EXPECT_EQ(answer_of_a_child_that_gets(SIGKILL), sandbox::End::died);
  try {
    sandbox::require_done({sandbox::End::died, ""}, copy);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::not_a_session);
    EXPECT_THAT(error.what_happened(), testing::HasSubstr("damaged or hostile"));
  }
}

struct Words {
  ExitCode code;
  std::string what, where, advice;
  bool operator==(const Words&) const = default;
};

template <typename Body>
Words words_of(Body body) {
  try {
    body();
  } catch (const Error& error) {
    return {error.code(), error.what_happened(), error.where(), error.advice()};
  }
  return {};
}

TEST_F(Trial, RefusesInTheWordsThatThisProcessWouldUse) {
  write_session(path(), synthetic_session(2));
  std::vector<char> bytes = read_file(path());
  bytes.resize(bytes.size() / 2);
  write_file(path(), bytes);
  const Words here = words_of([&] { read_session(path()); });
  EXPECT_EQ(here.where, path().string());
  EXPECT_EQ(in_a_program([&] { return words_of([&] { read_session(path()); }) == here ? 0 : 1; }), 0);
}

// What libhdf5 makes of a damaged file may differ from process to process: it is asked in one that may die.
TEST_F(Trial, LeavesWhatTheChildRefusedUnread) {
  write_session(path(), synthetic_session(2));
  const pid_t child = ::fork();
  if (child == 0) {
    sandbox::start({[](const sandbox::SealedCopy&, std::string_view) -> std::string {
      throw Error(ExitCode::not_a_session, "is refused for the sake of a test", "session", "nothing");
    }});
    const Words words = words_of([&] { read_session(path()); });
    ::_exit(words.what == "is refused for the sake of a test" && words.where == path() ? 0 : 1);
  }
  int status = 1;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

TEST_F(Trial, BelievesNoRefusalThatItsChildDidNotWrite) {
  const std::string text =
      sandbox::refusal_text(Error(ExitCode::failed, "what", "session/gyro", "do\x1b[2Jthat"));
  const Words words = words_of([&] { sandbox::refuse_as_told(text, "a/b.h5"); });
  EXPECT_EQ(words, (Words{ExitCode::failed, "what", "a/b.h5/gyro", "do\\u{1B}[2Jthat"}));
  for (std::size_t i = 0; i < text.size(); ++i) {
    const Words cut = words_of([&] { sandbox::refuse_as_told(text.substr(0, i), "a/b.h5"); });
    EXPECT_EQ(cut.code, ExitCode::not_a_session) << i;
    EXPECT_THAT(cut.what, testing::HasSubstr("damaged or hostile")) << i;
  }
  for (const std::string& other : {"X" + text, text + "more"})
    EXPECT_THAT(words_of([&] { sandbox::refuse_as_told(other, "a/b.h5"); }).what,
                testing::HasSubstr("damaged or hostile"));
}

// Whoever ends a recording with Ctrl-C at a terminal sends it to all processes of the recorder.
TEST_F(Trial, IsNotEndedByTheProgramsCtrlC) {
  write_session(path(), synthetic_session(2));
  const pid_t program = ::fork();
  if (program == 0) {
    ::setpgid(0, 0);  // a group of its own, as at a terminal
    std::signal(SIGINT, SIG_IGN);
    try_sessions_first();
    const pid_t busy = ::fork();
    while (busy == 0) ::kill(0, SIGINT);  // to all of the group
    int died = 0, refused = 0;
    for (int i = 0; i < 5; ++i) refused += code_of_reading(path(), synthetic_session(2), died) == 0 ? 0 : 1;
    ::kill(busy, SIGKILL);
    ::waitpid(busy, nullptr, 0);
    ::_exit(refused);
  }
  int status = 0;
  ::waitpid(program, &status, 0);
  EXPECT_EQ(status, 0);
}

/// Whether the kernel can refuse calls to a process, and this program knows how to ask.
bool calls_are_filtered() {
#if defined(__x86_64__) || defined(__aarch64__)
  return ::prctl(PR_GET_SECCOMP, 0, 0, 0, 0) >= 0;
#else
  return false;
#endif
}

/// Calls by which a process that was taken over could do harm. Asked of the kernel itself: a sanitizer stands
/// before some of them in the C library.
std::vector<std::pair<const char*, std::function<long()>>> harmful_calls(const std::string& file,
                                                                         pid_t other) {
  const char* name = file.c_str();
  const auto memory = [](int protection) {
    return ::syscall(__NR_mmap, nullptr, 4096, protection, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  };
  return {{"unlinkat", [name] { return ::syscall(__NR_unlinkat, AT_FDCWD, name, 0); }},
          {"renameat2", [name] { return ::syscall(__NR_renameat2, AT_FDCWD, name, AT_FDCWD, "away", 0); }},
          {"fchmodat", [name] { return ::syscall(__NR_fchmodat, AT_FDCWD, name, 0777); }},
          {"truncate", [name] { return ::syscall(__NR_truncate, name, 0); }},
          {"openat to read", [name] { return ::syscall(__NR_openat, AT_FDCWD, name, O_RDONLY); }},
          {"openat to write", [name] { return ::syscall(__NR_openat, AT_FDCWD, name, O_WRONLY); }},
          {"socket", [] { return ::syscall(__NR_socket, AF_UNIX, SOCK_STREAM, 0); }},
          {"kill", [other] { return ::syscall(__NR_kill, other, 0); }},
          {"ptrace", [] { return ::syscall(__NR_ptrace, PTRACE_TRACEME, 0, nullptr, nullptr); }},
          {"process_vm_readv",
           [other] { return ::syscall(__NR_process_vm_readv, other, nullptr, 0, nullptr, 0, 0); }},
          {"clone", [] { return ::syscall(__NR_clone, SIGCHLD, nullptr, nullptr, nullptr, 0); }},
          {"execve", [] { return ::syscall(__NR_execve, "/bin/true", nullptr, nullptr); }},
          {"prctl", [] { return ::syscall(__NR_prctl, PR_SET_DUMPABLE, 1, 0, 0, 0); }},
          {"mmap to execute", [memory] { return memory(PROT_READ | PROT_EXEC); }}};
}

TEST_F(Sandbox, RefusesEveryCallThatCouldDoHarm) {
  if (!calls_are_filtered()) GTEST_SKIP() << "this kernel or processor has no filter of system calls";
  write_file(path("there"), {'x'});
  const auto calls = harmful_calls(path("there").string(), ::getpid());
  const int status = in_sandbox([&] {
    for (std::size_t i = 0; i < calls.size(); ++i)
      if (calls[i].second() != -1 || errno != EPERM) return static_cast<int>(i + 1);
    return 0;
  });
  ASSERT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 0) << calls[WEXITSTATUS(status) - 1U].first << " was not refused";
  EXPECT_TRUE(std::filesystem::exists(path("there")));
}

TEST_F(Sandbox, LetsMemoryAndTheAnswerThrough) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  EXPECT_EQ(in_sandbox([&] {
              std::vector<std::vector<char>> memory;
              for (std::size_t size = 16; size < 32'000'000; size *= 2) memory.emplace_back(size, 'x');
              return ::write(ends[1], memory.back().data(), 1) == 1 ? 0 : 1;
            }),
            0);
  char answer = 0;
  EXPECT_EQ(::read(ends[0], &answer, 1), 1);
  EXPECT_EQ(answer, 'x');
  for (const int end : ends) ::close(end);
}

#if defined(__x86_64__)
TEST_F(Sandbox, EndsWhoeverCallsByTheNumbersOfAnotherArchitecture) {
  if (!calls_are_filtered()) GTEST_SKIP() << "this kernel has no filter of system calls";
  constexpr long x32 = 0x40000000;
  const int status = in_sandbox([] { return static_cast<int>(::syscall(x32 | __NR_getpid)) & 0; });
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGSYS);
}
#endif

#if !defined(THERMORIG_IS_SANITIZED)  // a sanitizer needs all of it
TEST_F(Sandbox, LetsNobodyIgnoreItsAlarm) {
  if (!calls_are_filtered()) GTEST_SKIP() << "this kernel or processor has no filter of system calls";
  EXPECT_EQ(in_sandbox([] { return std::signal(SIGALRM, SIG_IGN) == SIG_ERR ? 0 : 1; }), 0);
}

TEST_F(Sandbox, OpensNothing) {
  write_file(path("there"), {'x'});
  EXPECT_EQ(in_sandbox([&] { return ::open(path("there").c_str(), O_RDONLY) < 0 ? 0 : 1; }), 0);
}

TEST_F(Sandbox, GivesNoMoreMemoryThanASessionNeeds) {
  EXPECT_EQ(in_sandbox([] {
              try {
                std::vector<char> much(3ULL << 30U);
                return 1;
              } catch (const std::bad_alloc&) {
                return 0;
              }
            }),
            0);
}
#endif

}  // namespace
}  // namespace thermorig::session
