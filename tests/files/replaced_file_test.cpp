// SPDX-License-Identifier: MIT
// A file that is written anew: by kinds of place, and beside other programs.
#include "thermorig/io/files/replaced_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/file.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <iterator>

#include "session/temporary_folder.h"
#include "support/as_nobody.h"
#include "support/file_text.h"
#include "thermorig/core/error.h"
#include "thermorig/io/files/holder.h"
#include "thermorig/io/files/whole_file.h"

namespace thermorig::files {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// "code: what | advice", "" if nothing is refused.
std::string refused(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return std::to_string(static_cast<int>(error.code())) + ": " + error.what_happened() + " | " +
           error.advice();
  }
  return "";
}

/// Another program that has `file` open in one way, until this goes.
class OtherProgram {
 public:
  OtherProgram(const fs::path& file, int flags, int lock) {
    int ready[2] = {-1, -1};
    if (::pipe(ready) != 0) return;
    process_ = ::fork();
    if (process_ == 0) {
      const int descriptor = ::open(file.c_str(), flags);
      if (lock != 0) ::flock(descriptor, lock | LOCK_NB);
      (void)!::write(ready[1], "x", 1);
      for (;;) ::pause();
    }
    char byte = 0;
    (void)!::read(ready[0], &byte, 1);
    ::close(ready[0]);
    ::close(ready[1]);
  }
  ~OtherProgram() {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  OtherProgram(const OtherProgram&) = delete;
  OtherProgram& operator=(const OtherProgram&) = delete;
  std::string name() const { return "process " + std::to_string(process_); }

 private:
  pid_t process_ = -1;
};

class Replaced : public session::InTemporaryFolder {
 protected:
  void SetUp() override {
    InTemporaryFolder::SetUp();
    file_ = folder_ / "a.bin";
    std::ofstream(file_) << "old";
  }

  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), {}));
  }
  static void replace(const fs::path& path) { write_whole(path, "new", "the model"); }

  fs::path file_;
};

using KindOfPlace = Replaced;

TEST_F(KindOfPlace, ThatCannotTakeItIsRefusedBeforeAnythingIsWritten) {
  fs::create_directory(folder_ / "folder");
  ::mkfifo((folder_ / "pipe").c_str(), 0600);
  fs::create_symlink("loop", folder_ / "loop");
  fs::create_symlink("pipe", folder_ / "to-pipe");
  std::ofstream(folder_ / "protected") << "old";
  fs::permissions(folder_ / "protected", fs::perms{0444});
  const std::string long_name(250, 'x');
  struct Place {
    const char* what;
    fs::path path;
    const char* refusal;
  };
  const Place places[] = {
      {"a folder", folder_ / "folder", "7: cannot write the model: the name is taken by a folder, a pipe"},
      {"a pipe", folder_ / "pipe", "7: cannot write the model: the name is taken by a folder, a pipe"},
      {"a link to a pipe", folder_ / "to-pipe", "7: cannot write the model: the name is taken by a folder"},
      {"a device", "/dev/null", "7: cannot write the model: the name is taken by a folder, a pipe or a"},
      {"a link to itself", folder_ / "loop", "7: cannot write the model: Too many levels of symbolic links"},
      {"protected", folder_ / "protected", "7: cannot write the model: it is write-protected | choose"},
      {"a long name", folder_ / long_name, "7: cannot create the model: File name too long | choose a short"},
      {"no folder", folder_ / "no" / "a", "7: cannot create the model: No such file or directory | create"},
      {"below a file", file_ / "a", "7: cannot create the model: Not a directory | create the folder first"}};
  const std::size_t before = entries();
  for (const Place& place : places)
    EXPECT_THAT(refused([&] { PartFile(ReplacedFile(place.path, "the model")); }),
                testing::StartsWith(place.refusal))
        << place.what;
  EXPECT_EQ(entries(), before);
}

TEST_F(KindOfPlace, ThatThisUserMayNotChangeIsRefused) {
  fs::permissions(file_, fs::perms{0666});
  fs::permissions(folder_, fs::perms{0555});
  EXPECT_EQ(tests::code_as_nobody([&] { PartFile(ReplacedFile(file_, "the model")); }, "that you may write"),
            7);
  fs::permissions(folder_, fs::perms{01777});  // as /tmp
  EXPECT_EQ(tests::code_as_nobody([&] { PartFile(ReplacedFile(file_, "the model")); }, "that you may write"),
            ::geteuid() == 0 ? 7 : 0);
  fs::permissions(file_, fs::perms{0000});
  EXPECT_EQ(tests::code_as_nobody([&] { PartFile(ReplacedFile(file_, "the model")); }, "ls -l"), 6);
}

/// In a namespace of mounts that only a child has.
TEST_F(KindOfPlace, ThatIsMountedByItselfIsRefused) {
  std::ofstream(folder_ / "source") << "mounted";
  const pid_t process = ::fork();
  if (process == 0) {
    if (::unshare(CLONE_NEWUSER | CLONE_NEWNS) != 0 ||
        ::mount((folder_ / "source").c_str(), file_.c_str(), nullptr, MS_BIND, nullptr) != 0)
      ::_exit(77);
    const std::string refusal = refused([&] { PartFile(ReplacedFile(file_, "the model")); });
    ::_exit(refusal.starts_with("7: cannot write the model: it is mounted by itself") ? 0 : 1);
  }
  int status = 0;
  ::waitpid(process, &status, 0);
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  if (code == 77) GTEST_SKIP() << "this machine lets nobody have mounts of his own";
  EXPECT_EQ(code, 0);
}

TEST_F(KindOfPlace, BehindALinkChangesAndTheLinkStays) {
  fs::create_directory(folder_ / "far");
  fs::create_symlink("../a.bin", folder_ / "far" / "near");
  fs::create_symlink("far/near", folder_ / "link");
  replace(folder_ / "link");
  EXPECT_EQ(tests::file_text(file_), "new");
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  fs::create_symlink("far/made.bin", folder_ / "dangling");
  replace(folder_ / "dangling");
  EXPECT_EQ(tests::file_text(folder_ / "far" / "made.bin"), "new");
  EXPECT_TRUE(fs::is_symlink(folder_ / "dangling"));
}

class Access : public Replaced {
 protected:
  struct stat state() const {
    struct stat info {};
    EXPECT_EQ(::stat(file_.c_str(), &info), 0);
    return info;
  }
};

TEST_F(Access, StaysAsItWas) {
  for (const mode_t mode : {0600U, 0640U, 0664U, 0644U, 0700U}) {
    ASSERT_EQ(::chmod(file_.c_str(), mode), 0);
    replace(file_);
    EXPECT_EQ(state().st_mode & ALLPERMS, mode) << std::oct << mode;
  }
  if (::geteuid() != 0) GTEST_SKIP() << "only root may give files away";
  ASSERT_EQ(::chown(file_.c_str(), 1234, 2345), 0);
  replace(file_);
  EXPECT_EQ(state().st_uid, 1234U);
  EXPECT_EQ(state().st_gid, 2345U);
}

TEST_F(Access, IsNobodyElsesWhileItIsWritten) {
  ASSERT_EQ(::chmod(file_.c_str(), 0600), 0);
  const PartFile part(ReplacedFile(file_, "the model"));
  struct stat info {};
  ASSERT_EQ(::stat(part_path_of(file_).c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & ALLPERMS, 0600U);
}

TEST_F(Access, ThatWasTakenAwayMeanwhileIsTakenAway) {
  PartFile part(ReplacedFile(file_, "the model"));
  ASSERT_EQ(::chmod(file_.c_str(), 0600), 0);
  part.publish();
  EXPECT_EQ(state().st_mode & ALLPERMS, 0600U);
}

TEST_F(Access, OfAListIsKeptAndNoneIsInherited) {
  // Version 2; user::rw-, user:1234:r--, group::---, mask::r--, other::---
  const unsigned char list[] = {2,    0,    0,    0,    1,    0, 6, 0, 0xFF, 0xFF, 0xFF, 0xFF, 2,    0, 4, 0,
                                0xD2, 4,    0,    0,    4,    0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF, 0x10, 0, 4, 0,
                                0xFF, 0xFF, 0xFF, 0xFF, 0x20, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF};
  constexpr const char* of_a_file = "system.posix_acl_access";
  if (::setxattr(folder_.c_str(), "system.posix_acl_default", list, sizeof(list), 0) != 0)
    GTEST_SKIP() << "this file system has no lists of access";
  ASSERT_EQ(::chmod(file_.c_str(), 0600), 0);
  replace(file_);
  EXPECT_EQ(::getxattr(file_.c_str(), of_a_file, nullptr, 0), -1) << "it had none";
  EXPECT_EQ(state().st_mode & ALLPERMS, 0600U);
  ASSERT_EQ(::setxattr(file_.c_str(), of_a_file, list, sizeof(list), 0), 0);
  replace(file_);
  std::string kept(sizeof(list), '\0');
  EXPECT_EQ(::getxattr(file_.c_str(), of_a_file, kept.data(), kept.size()),
            static_cast<ssize_t>(sizeof(list)));
  EXPECT_EQ(kept, std::string(reinterpret_cast<const char*>(list), sizeof(list)));
}

TEST_F(Access, ThatCannotBeKeptIsRefusedAndLeavesNoPart) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root may make such a file";
  ASSERT_EQ(::chown(file_.c_str(), 1234, 2345), 0);
  ASSERT_EQ(::chmod(file_.c_str(), 0666), 0);
  fs::permissions(folder_, fs::perms{0777});
  EXPECT_EQ(tests::code_as_nobody([&] { PartFile(ReplacedFile(file_, "the model")); }, "ask its owner"), 6);
  EXPECT_EQ(entries(), 1U);
}

class BesideAnotherProgram : public Replaced {};

TEST_F(BesideAnotherProgram, ThatWritesItNothingIsReplacedAndItIsNamed) {
  struct Way {
    const char* what;
    int flags, lock;
  };
  for (const Way& way : {Way{"HDF5, open to write", O_RDWR, LOCK_EX},
                         Way{"HDF5 without locks (HDF5_USE_FILE_LOCKING=FALSE)", O_RDWR, 0}}) {
    const OtherProgram other(file_, way.flags, way.lock);
    const std::string refusal = refused([&] { ReplacedFile(file_, "the model").lock(); });
    EXPECT_THAT(refusal, testing::StartsWith("6: the model is open to be written in " + other.name()))
        << way.what;
  }
}

TEST_F(BesideAnotherProgram, ThatBeginsToWriteItLaterNothingIsReplaced) {
  PartFile part(ReplacedFile(file_, "the model"));
  const OtherProgram other(file_, O_RDWR, LOCK_EX);
  EXPECT_THAT(refused([&] { part.publish(); }), testing::StartsWith("6: the model was changed meanwhile"));
  EXPECT_EQ(tests::file_text(file_), "old");
}

TEST_F(BesideAnotherProgram, ThatReadsItItIsReplaced) {
  const OtherProgram other(file_, O_RDONLY, LOCK_SH);  // HDF5, open to read
  ReplacedFile old(file_, "the model");
  old.lock();
  const OtherProgram later(file_, O_RDONLY, LOCK_SH);
  PartFile part(std::move(old));
  part.publish();
  EXPECT_EQ(tests::file_text(file_), "");
}

TEST_F(BesideAnotherProgram, ThatReplacesItOneGoesOnAndTheOtherIsRefused) {
  ReplacedFile one(file_, "the model"), other(file_, "the model");
  one.lock();
  EXPECT_THAT(refused([&] { other.lock(); }), testing::StartsWith("6: the model is open to be written in"));
}

/// What may happen between the look at a file and its replacement.
TEST_F(BesideAnotherProgram, ThatWasFasterItsFileStays) {
  struct Change {
    const char* what;
    std::function<void()> make;
    std::string then;
  };
  const Change changes[] = {
      {"replaced", [&] { fs::rename(folder_ / "other", file_); }, "xyz"},
      {"written in place", [&] { std::ofstream(file_) << "longer"; }, "longer"},
      {"moved away", [&] { fs::rename(file_, folder_ / "moved"); }, ""},
  };
  for (const Change& change : changes) {
    std::ofstream(folder_ / "other") << "xyz";
    std::ofstream(file_) << "old";
    ReplacedFile old(file_, "the model");
    change.make();
    EXPECT_THAT(refused([&] { old.lock(); }), testing::StartsWith("6: another program has just replaced"))
        << change.what;
    PartFile part(std::move(old));
    EXPECT_THAT(refused([&] { part.publish(); }), testing::StartsWith("6: the model was changed mean"))
        << change.what;
    EXPECT_EQ(fs::exists(file_) ? tests::file_text(file_) : "", change.then) << change.what;
  }
}

TEST_F(BesideAnotherProgram, ThatMakesItFirstItsFileStays) {
  fs::remove(file_);
  PartFile part(ReplacedFile(file_, "the model"));
  std::ofstream(file_) << "first";
  EXPECT_FALSE(part.publish_unless_taken());
  EXPECT_EQ(tests::file_text(file_), "first");
}

TEST_F(Replaced, HoldersAreFoundByAnyNameOfTheFile) {
  fs::create_symlink("a.bin", folder_ / "link");
  const OtherProgram reader(file_, O_RDONLY, 0);
  EXPECT_THAT(other_holder_of(folder_ / "link").value_or(""), HasSubstr(reader.name()));
  EXPECT_EQ(other_holder_of(file_, Use::writing), std::nullopt);
  const OtherProgram writer(file_, O_WRONLY, 0);
  EXPECT_THAT(other_holder_of(folder_ / "." / "a.bin", Use::writing).value_or(""), HasSubstr(writer.name()));
}

}  // namespace
}  // namespace thermorig::files
