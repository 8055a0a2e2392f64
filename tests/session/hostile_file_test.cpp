// SPDX-License-Identifier: MIT
// Files that were made to harm who reads them: a child reads first, and dies in our place.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <random>

#include "cage.h"
#include "equality.h"
#include "leave.h"
#include "synthetic_session.h"
#include "temporary_folder.h"
#include "thermorig/core/error.h"
#include "thermorig/session/session.h"
#include "thermorig/session/trial.h"

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
    leave(body());
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
  const SealedCopy copy(path("whole.h5"));
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
    const bool is_file = SealedCopy(path("whole.h5")).fd() >= 0;
    const int code = code_of_reading(path("whole.h5"), truth_, died);
    ::setrlimit(RLIMIT_FSIZE, &before);
    return is_file ? 101 : code;
  });
  EXPECT_EQ(status, 0);
}

// Mutants ($THERMORIG_MUTANTS: how many), each read by a program that goes on: whatever libhdf5 does with
// them, it does to a child.
TEST_F(HostileSession, NeverHarmsTheProgram) {
  const char* asked = std::getenv("THERMORIG_MUTANTS");
  const int mutants = asked == nullptr ? 400 : std::atoi(asked);
  const auto report = path("died");
  const int status = in_a_program([&] {
    std::mt19937 random(23);
    const auto places = structures();
    int died = 0, refused = 0;
    for (int i = 0; i < mutants; ++i) {
      write_file(path("mutant.h5"), mutant(random, places));
      const int code = code_of_reading(path("mutant.h5"), truth_, died);
      if (code != 0 && code != static_cast<int>(ExitCode::not_a_session)) return 1 + code;
      refused += code == 0 ? 0 : 1;
    }
    std::cout << mutants << " mutants: " << refused << " refused, " << died
              << " of them killed their reader or kept it busy" << std::endl;
    return refused > mutants / 4 ? 0 : 1;
  });
  EXPECT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

class Cage : public InTemporaryFolder {
 protected:
  template <typename Body>
  static int in_cage(Body body) {
    const pid_t child = ::fork();
    if (child == 0) {
      enter_cage(1000);
      ::_exit(body());  // without counts of lines: it may open no file for them
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return status;
  }
};

TEST_F(Cage, EndsWhoeverIsBusyForTooLong) {
  const pid_t child = ::fork();
  if (child == 0) {
    enter_cage(0);
    rlimit shorter{1, 1};  // the limit that it has set can only be lowered
    ::setrlimit(RLIMIT_CPU, &shorter);
    std::mt19937 busy;
    while (true) busy.discard(1'000'000);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status));
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // a sanitizer needs both
TEST_F(Cage, OpensNothing) {
  write_file(path("there"), {'x'});
  EXPECT_EQ(in_cage([&] { return ::open(path("there").c_str(), O_RDONLY) < 0 ? 0 : 1; }), 0);
}

TEST_F(Cage, GivesNoMoreMemoryThanASessionNeeds) {
  EXPECT_EQ(in_cage([] {
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
