// SPDX-License-Identifier: MIT
// Files that were made to harm who reads them: a child reads first, and dies in our place.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <random>
#include <thread>
#include <utility>

#include "equality.h"
#include "storage/session/trial.h"
#include "synthetic_session.h"
#include "temporary_folder.h"
#include "thermorig/core/error.h"
#include "thermorig/storage/session/session.h"
#include "thermorig/storage/session/trial.h"

namespace thermorig::session {
namespace {

using Bytes = std::vector<char>;
using testing::HasSubstr;

constexpr int usual_mutants = 40;

template <typename Call>
Error error_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error;
  }
  return Error(ExitCode::ok, "nothing was thrown", "", "");
}

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

// Mutants ($THERMORIG_MUTANTS: how many), each read by a program that goes on: whatever libhdf5 does with
// them, it does to a child.
TEST_F(HostileSession, NeverHarmsTheProgram) {
  const char* asked = std::getenv("THERMORIG_MUTANTS");
  const int mutants = asked == nullptr ? usual_mutants : std::atoi(asked);
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

class Opened : public InTemporaryFolder {
 protected:
  void SetUp() override {
    InTemporaryFolder::SetUp();
    write_session(path("one.h5"), truth_);
  }
  const Session truth_ = synthetic_session(12);
};

TEST_F(Opened, IsTheFileThatHadTheNameThen) {
  const StoredFile file(path("one.h5"));
  write_file(path("other"), {'x'});
  std::filesystem::rename(path("other"), path("one.h5"));
  EXPECT_EQ(difference(truth_, read_session(file)), "");
}

#if !defined(THERMORIG_IS_SANITIZED)  // libhdf5 loses some bytes where it cannot read
TEST_F(Opened, SaysIfItBecameShorterMeanwhile) {
  const StoredFile file(path("one.h5"));
  std::filesystem::resize_file(path("one.h5"), file.size() / 2);
  const Error error = error_of([&] { read_session(file); });
  EXPECT_EQ(error.code(), ExitCode::storage);
  EXPECT_THAT(error.what_happened(), HasSubstr("became shorter"));
  EXPECT_EQ(in_a_program([&] {
              return error_of([&] { read_session(file); }).what_happened() == error.what_happened() ? 0 : 1;
            }),
            0);
}

#endif

TEST_F(Opened, IsNoGitLfsPointer) {
  const std::string pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:01\nsize 84321\n";
  write_file(path(), {pointer.begin(), pointer.end()});
  const Error error = error_of([&] { StoredFile file(path()); });
  EXPECT_EQ(error.code(), ExitCode::not_a_session);
  EXPECT_THAT(error.what_happened(), HasSubstr("Git LFS pointer"));
  EXPECT_THAT(error.advice(), HasSubstr("git lfs pull"));
}

// Of a hole: it takes nothing of the disk.
TEST_F(Opened, IsNotLargerThanAnySession) {
  std::filesystem::resize_file(path("one.h5"), (4ULL << 30U) + 1);
  const Error error = error_of([&] { StoredFile{path("one.h5")}; });
  EXPECT_EQ(error.code(), ExitCode::not_a_session);
  EXPECT_THAT(error.what_happened(), HasSubstr("larger than any session"));
}

/// What a child that reads this way makes of a file.
class TrialOfAFile : public InTemporaryFolder {
 protected:
  void SetUp() override {
    InTemporaryFolder::SetUp();
    write_file(path(), {'x'});
  }
  /// `signal`: is sent to the child.
  void try_with(const std::function<void()>& read, int signal = 0) const {
    const StoredFile file(path());
    Trial trial(file, read);
    if (signal != 0) ::kill(only_child(), signal);
    trial.require_good();
  }
  static pid_t only_child() {
    pid_t child = 0;
    std::ifstream("/proc/self/task/" + std::to_string(::gettid()) + "/children") >> child;
    return child;
  }
  static void wait_for_ever() {
    for (std::mt19937 busy;; busy.discard(1000)) continue;
  }
  static void* nowhere() { return nullptr; }
  std::string refusal_of(const std::function<void()>& read, int signal = 0) const {
    const Error error = error_of([&] { try_with(read, signal); });
    EXPECT_EQ(error.code(), ExitCode::not_a_session);
    EXPECT_EQ(error.where(), path().string());
    return error.what_happened();
  }
};

TEST_F(TrialOfAFile, IsGoodIfItIsReadToItsEnd) {
  EXPECT_NO_THROW(try_with([] {}));
}

TEST_F(TrialOfAFile, SaysWhatEndedItsReader) {
  EXPECT_THAT(refusal_of([] { *static_cast<volatile int*>(nowhere()) = 0; }),
              HasSubstr("damaged or hostile"));
  EXPECT_THAT(refusal_of(wait_for_ever, SIGKILL), HasSubstr("was ended by SIGKILL"));
  EXPECT_THAT(refusal_of([] { ::_exit(7); }), HasSubstr("damaged or hostile"));
  EXPECT_THAT(refusal_of([] { throw std::runtime_error("?"); }), HasSubstr("damaged or hostile"));
}

TEST_F(TrialOfAFile, EndsAReaderThatIsBusyForTooLong) {
  EXPECT_THAT(refusal_of(wait_for_ever, SIGXCPU), HasSubstr(" s of processor time"));
  EXPECT_THAT(refusal_of(wait_for_ever, SIGALRM), HasSubstr("was not done"));
  const auto limited = [] {
    rlimit limit{};
    ::getrlimit(RLIMIT_CPU, &limit);
    if (limit.rlim_cur > 60) throw Error(ExitCode::failed, "has all the time there is", "", "");
  };
  EXPECT_NO_THROW(try_with(limited));
}

TEST_F(TrialOfAFile, RefusesInTheWordsOfItsReader) {
  const Error error = error_of(
      [&] { try_with([&] { throw Error(ExitCode::failed, "what\x1b[2J", path().string(), "do\nthat"); }); });
  EXPECT_EQ(error.code(), ExitCode::failed);
  EXPECT_EQ(error.what_happened(), "what\\u{1B}[2J");
  EXPECT_EQ(error.where(), path().string());
  EXPECT_EQ(error_of([&] { try_with([] { throw Error(ExitCode::ok, "what", "", ""); }); }).code(),
            ExitCode::not_a_session);
}

TEST_F(TrialOfAFile, SaysOfACutSessionWhatThisProcessWouldSay) {
  write_session(path("whole.h5"), synthetic_session(2));
  std::filesystem::resize_file(path("whole.h5"), std::filesystem::file_size(path("whole.h5")) / 2);
  const auto text = [&] {
    const Error error = error_of([&] { read_session(path("whole.h5")); });
    return error.what_happened() + error.where() + error.advice();
  };
  const std::string here = text();
  EXPECT_EQ(in_a_program([&] { return text() == here ? 0 : 1; }), 0);
}

TEST_F(TrialOfAFile, NamesAlteredAttributesAsWithoutAChild) {
  std::filesystem::remove(path());
  write_session(path(), synthetic_session(2));
  std::vector<char> bytes = read_file(path());
  const std::string clock = "CLOCK_MONOTONIC";
  *(std::search(bytes.begin(), bytes.end(), clock.begin(), clock.end())) = 'X';
  write_file(path(), bytes);
  const std::vector<std::string> altered{"/sync@host_clock"};
  EXPECT_EQ(altered_attributes(StoredFile(path())), altered);
  EXPECT_EQ(in_a_program([&] { return altered_attributes(StoredFile(path())) == altered ? 0 : 1; }), 0);
}

// Whoever ends a recording with Ctrl-C at a terminal sends it to all processes of the recorder.
TEST_F(TrialOfAFile, GoesOnWhenTheTerminalInterrupts) {
  const StoredFile file(path());
  Trial trial(file, [] {});
  ::kill(only_child(), SIGINT);
  EXPECT_NO_THROW(trial.require_good());
}

TEST_F(TrialOfAFile, IsNotBelievedGoodWhereItsEndIsUnknown) {
  const auto before = std::signal(SIGCHLD, SIG_IGN);  // the system then tells nobody how children end
  EXPECT_THAT(refusal_of([] {}), HasSubstr("damaged or hostile"));
  std::signal(SIGCHLD, before);
}

/// With a sanitizer these threads read without a trial.
TEST_F(TrialOfAFile, MayBeMadeByManyThreadsAtOnce) {
  write_session(path("whole.h5"), synthetic_session(12));
  EXPECT_EQ(in_a_program([&] {
              std::atomic<int> read = 0;
              std::vector<std::thread> threads;
              for (int i = 0; i < 4; ++i)
                threads.emplace_back([&] {
                  for (int j = 0; j < 5; ++j) read += read_session(path("whole.h5")).frames.size() == 12;
                });
              for (std::thread& thread : threads) thread.join();
              return read == 20 ? 0 : 1;
            }),
            0);
}

/// Kernels and processors without a filter of system calls have the other limits alone.
bool calls_are_filtered() {
  return ::prctl(PR_GET_SECCOMP, 0, 0, 0, 0) >= 0;
}

/// What could do harm. Asked of the kernel itself: a sanitizer stands before some of them in the C library.
std::vector<std::pair<const char*, std::function<long()>>> harmful_calls(const std::string& file) {
  const char* name = file.c_str();
  return {{"unlinkat", [name] { return ::syscall(__NR_unlinkat, AT_FDCWD, name, 0); }},
          {"renameat2", [name] { return ::syscall(__NR_renameat2, AT_FDCWD, name, AT_FDCWD, "away", 0); }},
          {"openat to write", [name] { return ::syscall(__NR_openat, AT_FDCWD, name, O_WRONLY); }},
          {"socket", [] { return ::syscall(__NR_socket, AF_UNIX, SOCK_STREAM, 0); }},
          {"kill", [] { return ::syscall(__NR_kill, ::getppid(), 0); }},
          {"clone", [] { return ::syscall(__NR_clone, SIGCHLD, nullptr, nullptr, nullptr, 0); }},
          {"execve", [] { return ::syscall(__NR_execve, "/bin/true", nullptr, nullptr); }},
          {"mmap to execute", [] {
             return ::syscall(__NR_mmap, nullptr, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS,
                              -1, 0);
           }}};
}

TEST_F(TrialOfAFile, RefusesItsReaderEveryCallThatCouldDoHarm) {
  if (!calls_are_filtered()) GTEST_SKIP() << "this kernel or processor has no filter of system calls";
  for (const auto& harmful : harmful_calls(path().string()))
    EXPECT_NO_THROW(try_with([&harmful] {
      if (harmful.second() != -1 || errno != EPERM) throw Error(ExitCode::failed, "did harm", "", "");
    })) << harmful.first;
  EXPECT_TRUE(std::filesystem::exists(path()));
}

#if !defined(THERMORIG_IS_SANITIZED)  // a sanitizer needs all of it
TEST_F(TrialOfAFile, WritesNothingButItsAnswer) {
  if (!calls_are_filtered()) GTEST_SKIP() << "this kernel or processor has no filter of system calls";
  const int file = ::open(path().c_str(), O_WRONLY);
  EXPECT_NO_THROW(try_with([&] {
    if (::write(file, "y", 1) == 1) throw Error(ExitCode::failed, "wrote", "", "");
  }));
  ::close(file);
}

TEST_F(TrialOfAFile, GivesNoMoreMemoryThanASessionNeeds) {
  EXPECT_THAT(refusal_of([] { std::vector<char> much(3ULL << 30U); }), HasSubstr("ended by itself"));
}
#endif

}  // namespace
}  // namespace thermorig::session
