// SPDX-License-Identifier: MIT
// What writing a session says of a disk that fails, and what it leaves there.
#include <gmock/gmock.h>

#include <cerrno>

#include "../journal/failing_disk.h"
#include "equality.h"
#include "replace_session.h"
#include "synthetic_session.h"
#include "temporary_folder.h"
#include "thermorig/core/error.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::session {
namespace {

using testing::HasSubstr;

/// Gives zeros back for a quarter of what was written.
class ForgetfulDisk : public journal::FailingDisk {
 public:
  files::Answer<std::size_t> read(files::OpenFile file, std::uint64_t offset,
                                  std::span<std::byte> out) override {
    const auto count = FailingDisk::read(file, offset, out);
    const auto part = out.subspan(count.value / 4, count.value / 4);
    std::fill(part.begin(), part.end(), std::byte{0});
    return count;
  }
};

class SessionDisk : public InTemporaryFolder {
 protected:
  template <typename Write>
  Error refusal(Write write, files::Disk& disk) {
    try {
      write(path(), session_, disk);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::storage);
      return error;
    }
    ADD_FAILURE() << "nothing was thrown";
    return Error(ExitCode::failed, "", "", "");
  }

  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder_), {}));
  }

  const Session session_ = synthetic_session(20);
  journal::FailingDisk disk_;
};

TEST_F(SessionDisk, EachFailureIsToldWithItsAdviceAndLeavesNoFile) {
  struct Failure {
    const char* call;
    int error_number;
    const char* advice;
  };
  const Failure failures[] = {{"look", EIO, "check the disk"},
                              {"look", EACCES, "a folder that you may write to"},
                              {"create", EROFS, "a folder that you may write to"},
                              {"create", ENOTDIR, "create the folder first"},
                              {"append", ENOSPC, "free some space"},
                              {"append", EDQUOT, "free some space"},
                              {"append", EFBIG, "free some space"},
                              {"read", EIO, "check the disk"},
                              {"sync", EIO, "the journal is still there"}};
  for (const auto& [call, error_number, advice] : failures) {
    disk_.errors = {{call, error_number}};
    EXPECT_THAT(refusal(write_session, disk_).advice(), HasSubstr(advice)) << call;
    EXPECT_EQ(files(), 0U) << call;
  }
}

TEST_F(SessionDisk, OneThatIsReplacedStaysUntilTheNewOneIsWhole) {
  write_session(path(), session_);
  const Session other = synthetic_session(10, 2);
  for (const char* call : {"create", "append", "read", "sync"}) {
    disk_.errors = {{call, EIO}};
    EXPECT_THROW(replace_session(path(), other, disk_), Error) << call;
    EXPECT_EQ(difference(session_, read_session(path())), "");
    EXPECT_EQ(files(), 1U);
  }
  disk_.errors.clear();
  replace_session(path(), other, disk_);
  EXPECT_EQ(difference(other, read_session(path())), "");
}

/// No journal is left of it, and those who replace sessions have no --output.
TEST_F(SessionDisk, OfOneThatIsReplacedTheAdviceIsAnother) {
  write_session(path(), session_);
  const auto replace = [](const std::filesystem::path& at, const Session& session, files::Disk& disk) {
    replace_session(at, session, disk);
  };
  for (const int error_number : {ENOSPC, EACCES, EIO}) {
    disk_.errors = {{"create", error_number}};
    const std::string advice = refusal(replace, disk_).advice();
    EXPECT_THAT(advice, HasSubstr("; the session is as it was")) << error_number;
    EXPECT_THAT(advice, testing::Not(HasSubstr("journal"))) << error_number;
    EXPECT_THAT(advice, testing::Not(HasSubstr("--output"))) << error_number;
  }
}

TEST_F(SessionDisk, ADiskThatGivesBackOtherBytesIsToldSo) {
  ForgetfulDisk disk;
  EXPECT_THAT(refusal(write_session, disk).advice(), HasSubstr("check the disk"));
  EXPECT_EQ(files(), 0U);
}

TEST_F(SessionDisk, ADiskThatTakesPartsGetsTheRest) {
  disk_.most_at_once = 10'000;
  write_session(path(), session_, disk_);
  EXPECT_EQ(difference(session_, read_session(path())), "");
}

}  // namespace
}  // namespace thermorig::session
