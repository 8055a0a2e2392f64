// SPDX-License-Identifier: MIT
#include "thermorig/storage/sandbox/sealed_copy.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>

#include "temporary_folder.h"
#include "thermorig/core/error.h"

namespace thermorig::session {
namespace {

using testing::HasSubstr;

std::string text_of(const sandbox::SealedCopy& copy) {
  return {reinterpret_cast<const char*>(copy.bytes().data()), copy.bytes().size()};
}

template <typename Call>
Error error_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "nothing was thrown";
  return Error(ExitCode::ok, "", "", "");
}

class Sealed : public InTemporaryFolder {
 protected:
  void SetUp() override {
    InTemporaryFolder::SetUp();
    write_file(path(), {'a', 'b', 'c'});
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends_.data()), 0);
  }
  void TearDown() override {
    for (const int end : ends_)
      if (end >= 0) ::close(end);
    InTemporaryFolder::TearDown();
  }

  /// The end is closed, or belongs to somebody else from now on.
  int give_away(std::size_t end) { return std::exchange(ends_[end], -1); }

  std::array<int, 2> ends_{-1, -1};
};

TEST_F(Sealed, CanBeHandedOnAsADescriptor) {
  const sandbox::SealedCopy copy(path());
  const sandbox::SealedCopy other(::dup(copy.fd()), "somewhere");
  write_file(path(), {'x'});
  EXPECT_EQ(text_of(other), "abc");
  EXPECT_EQ(other.path(), "somewhere");
}

TEST_F(Sealed, IsNotMadeOfAGitLfsPointer) {
  const std::string pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:01\nsize 84321\n";
  write_file(path(), {pointer.begin(), pointer.end()});
  const Error error = error_of([&] { sandbox::SealedCopy copy(path()); });
  EXPECT_EQ(error.code(), ExitCode::not_a_session);
  EXPECT_THAT(error.what_happened(), HasSubstr("Git LFS pointer"));
  EXPECT_THAT(error.advice(), HasSubstr("git lfs pull"));
}

TEST_F(Sealed, CanBeSentThroughASocket) {
  const sandbox::SealedCopy copy(path());
  ASSERT_TRUE(copy.send_bytes(ends_[0]));
  const sandbox::SealedCopy other(give_away(1), "somewhere");
  EXPECT_EQ(text_of(other), "abc");
  EXPECT_EQ(other.fd(), -1);
}

TEST_F(Sealed, SaysIfNobodyTakesWhatItSends) {
  ::close(give_away(1));
  EXPECT_FALSE(sandbox::SealedCopy(path()).send_bytes(ends_[0]));
}

TEST_F(Sealed, IsNotMadeOfASocketThatEndsEarly) {
  const std::uint64_t claimed = 10;
  ASSERT_EQ(::send(ends_[0], &claimed, sizeof claimed, 0), ssize_t{sizeof claimed});
  ASSERT_EQ(::send(ends_[0], "abc", 3, 0), 3);
  ::close(give_away(0));
  const Error error = error_of([&] { sandbox::SealedCopy(give_away(1), "somewhere"); });
  EXPECT_EQ(error.code(), ExitCode::storage);
  EXPECT_THAT(error.what_happened(), HasSubstr("became shorter"));
}

TEST_F(Sealed, IsNotMadeOfASocketThatClaimsMoreThanThereIsMemory) {
  const std::uint64_t claimed = std::uint64_t{1} << 62U;
  ASSERT_EQ(::send(ends_[0], &claimed, sizeof claimed, 0), ssize_t{sizeof claimed});
  EXPECT_EQ(error_of([&] { sandbox::SealedCopy(give_away(1), "somewhere"); }).code(), ExitCode::failed);
}

TEST_F(Sealed, IsMadeOfBytesInMemory) {
  std::array bytes{std::byte{'y'}, std::byte{'z'}};
  const sandbox::SealedCopy copy(bytes, "nowhere");
  bytes[0] = std::byte{'!'};
  EXPECT_EQ(text_of(copy), "yz");
}

TEST_F(Sealed, OfAnEmptyFileHasNoBytes) {
  write_file(path(), {});
  EXPECT_TRUE(sandbox::SealedCopy(path()).bytes().empty());
}

TEST_F(Sealed, BelongsToWhomItMovedTo) {
  sandbox::SealedCopy copy(path());
  const sandbox::SealedCopy other(std::move(copy));
  EXPECT_EQ(text_of(other), "abc");
  EXPECT_GE(other.fd(), 0);
}

TEST_F(Sealed, OfALargeFileIsReadWithoutItsPagesInMemory) {
  std::vector<char> bytes(sandbox::SealedCopy::small_bytes_max + 1, 'a');
  bytes.back() = 'z';
  write_file(path(), bytes);
  const sandbox::SealedCopy copy(path());
  write_file(path(), {'x'});
  copy.forget_pages();
  ASSERT_EQ(copy.bytes().size(), bytes.size());
  EXPECT_EQ(copy.bytes().front(), std::byte{'a'});
  EXPECT_EQ(copy.bytes().back(), std::byte{'z'});
}

TEST_F(Sealed, OfALargeFileCanBeWrittenByNobody) {
  std::filesystem::resize_file(path(), sandbox::SealedCopy::small_bytes_max + 1);
  const sandbox::SealedCopy copy(path());
  ASSERT_GE(copy.fd(), 0);
  EXPECT_LT(::write(copy.fd(), "x", 1), 0);
  EXPECT_NE(::ftruncate(copy.fd(), 0), 0);
  EXPECT_EQ(copy.bytes().front(), std::byte{'a'});
}

TEST_F(Sealed, OfManyBytesIsReadInOrderAndAPartAtATime) {
  constexpr std::uint64_t size = sandbox::SealedCopy::small_bytes_max + 5;
  std::uint64_t next = 0;
  const auto read_at = [&next](std::uint64_t offset, std::span<std::byte> out) {
    EXPECT_EQ(offset, next);
    next += out.size();
    std::fill(out.begin(), out.end(), std::byte{static_cast<unsigned char>(offset >> 20U)});
  };
  const sandbox::SealedCopy copy(size, read_at, path());
  EXPECT_EQ(next, size);
  EXPECT_EQ(copy.bytes().size(), size);
  EXPECT_EQ(copy.bytes().front(), std::byte{0});
}

// Of a hole: it takes nothing of the disk.
TEST_F(Sealed, OfMoreThanFourGibibytesIsRefused) {
  std::filesystem::resize_file(path(), (4ULL << 30U) + 1);
  const Error error = error_of([&] { sandbox::SealedCopy{path()}; });
  EXPECT_EQ(error.code(), ExitCode::not_a_session);
  EXPECT_THAT(error.what_happened(), HasSubstr("larger than any session"));
}

}  // namespace
}  // namespace thermorig::session
