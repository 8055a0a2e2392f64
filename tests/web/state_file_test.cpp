// SPDX-License-Identifier: MIT
#include "io/web/state_file.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "io/web/token.h"
#include "private_folder.h"
#include "support/file_text.h"
#include "thermorig/core/error.h"
#include "thermorig/io/web/server.h"

namespace thermorig::web {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;

namespace {

const std::string written_token(32, 'a');

unsigned mode_of(const std::filesystem::path& path) {
  struct stat info {};
  EXPECT_EQ(::stat(path.c_str(), &info), 0);
  return info.st_mode & 0777;
}

}  // namespace

TEST(Token, IsOf128BitsAndNeverTheSame) {
  const std::string first = make_token();
  EXPECT_THAT(first, MatchesRegex("[0-9a-f]{32}"));
  EXPECT_NE(first, make_token());
}

TEST(Token, IsComparedWhole) {
  EXPECT_TRUE(same_token(written_token, written_token));
  EXPECT_FALSE(same_token(written_token, std::string(31, 'a') + "b"));
  EXPECT_FALSE(same_token("b" + std::string(31, 'a'), written_token));
  EXPECT_FALSE(same_token(std::string(31, 'a'), written_token));
  EXPECT_FALSE(same_token("", ""));
}

TEST(StateFile, IsReadAsItWasWritten) {
  const PrivateFolder folder;
  const auto path = folder.path() / "a" / "b" / "page.json";
  write_state(path, {8650, written_token});
  const auto found = read_state(path);
  ASSERT_TRUE(found.state);
  EXPECT_EQ(found.state->port, 8650);
  EXPECT_EQ(found.state->token, written_token);
  EXPECT_EQ(found.refused, "");
}

TEST(StateFile, HasTheAddressThatOpensThePage) {
  const PrivateFolder folder;
  const auto path = folder.path() / "page.json";
  write_state(path, {8650, written_token});
  EXPECT_THAT(tests::file_text(path),
              HasSubstr("\"url\":\"http://127.0.0.1:8650/#t=" + written_token + "\""));
}

TEST(StateFile, IsForItsUserAlone) {
  const PrivateFolder folder;
  const mode_t before = ::umask(0);
  write_state(folder.path() / "new" / "page.json", {8650, written_token});
  EXPECT_EQ(::umask(before), 0U) << "the mask is as it was";
  EXPECT_EQ(mode_of(folder.path() / "new" / "page.json"), 0600U);
  EXPECT_EQ(mode_of(folder.path() / "new"), 0700U);
}

TEST(StateFile, BecomesPrivateAgainWhenItIsWritten) {
  const PrivateFolder folder;
  const auto path = folder.path() / "page.json";
  write_state(path, {8650, written_token});
  ::chmod(path.c_str(), 0644);
  write_state(path, {8650, written_token});
  EXPECT_EQ(mode_of(path), 0600U);
}

TEST(StateFile, IsRefusedIfOthersMayReadIt) {
  const PrivateFolder folder;
  const auto path = folder.path() / "page.json";
  write_state(path, {8650, written_token});
  for (const mode_t mode : {0640, 0604, 0620, 0602}) {
    ::chmod(path.c_str(), mode);
    const auto found = read_state(path);
    EXPECT_FALSE(found.state);
    EXPECT_THAT(found.refused, HasSubstr("others may read or write it"));
  }
}

TEST(StateFile, IsRefusedIfItIsALink) {
  const PrivateFolder folder;
  write_state(folder.path() / "real.json", {8650, written_token});
  std::filesystem::create_symlink(folder.path() / "real.json", folder.path() / "page.json");
  const auto found = read_state(folder.path() / "page.json");
  EXPECT_FALSE(found.state);
  EXPECT_THAT(found.refused, HasSubstr("link"));
}

TEST(StateFile, IsRefusedIfItBelongsToAnother) {
  const PrivateFolder folder;
  const auto path = folder.path() / "page.json";
  write_state(path, {8650, written_token});
  if (::chown(path.c_str(), 65'534, 65'534) != 0) GTEST_SKIP() << "only root can give a file away";
  EXPECT_THAT(read_state(path).refused, HasSubstr("another user"));
}

TEST(StateFile, IsNoPipeAndNoFolder) {
  const PrivateFolder folder;
  ASSERT_EQ(::mkfifo((folder.path() / "pipe").c_str(), 0600), 0);
  EXPECT_THAT(read_state(folder.path() / "pipe").refused, HasSubstr("no regular file"));
  EXPECT_THAT(read_state(folder.path()).refused, HasSubstr("no regular file"));
}

TEST(StateFile, IsNotBelievedIfItIsDamaged) {
  const PrivateFolder folder;
  const auto path = folder.path() / "page.json";
  for (const std::string& content :
       {std::string(""), std::string("{"), std::string("[]"), std::string(R"({"port":8650})"),
        R"({"port":0,"token":")" + written_token + "\"}",
        R"({"port":65537,"token":")" + written_token + "\"}",
        R"({"port":-1,"token":")" + written_token + "\"}", R"({"port":"1","token":")" + written_token + "\"}",
        std::string(R"({"port":8650,"token":"short"})"), std::string(R"({"port":8650,"token":7})"),
        std::string(100'000, '[')}) {
    std::ofstream(path) << content;
    ::chmod(path.c_str(), 0600);
    const auto found = read_state(path);
    EXPECT_FALSE(found.state) << content.substr(0, 60);
    EXPECT_EQ(found.refused, "it is damaged") << content.substr(0, 60);
  }
}

TEST(StateFile, MayBeMissing) {
  const PrivateFolder folder;
  const auto found = read_state(folder.path() / "none" / "page.json");
  EXPECT_FALSE(found.state);
  EXPECT_EQ(found.refused, "");
}

TEST(StateFile, ThatCannotBeWrittenIsAnError) {
  try {
    write_state("/proc/page/page.json", {8650, written_token});
    FAIL() << "it was written";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::storage);
  }
}

TEST(StateFile, LiesInTheUsersStateFolder) {
  ::setenv("XDG_STATE_HOME", "/somewhere/state", 1);
  EXPECT_EQ(default_state_file(), "/somewhere/state/thermorig/page.json");
  ::setenv("XDG_STATE_HOME", "not/absolute", 1);
  ::setenv("HOME", "/home/someone", 1);
  EXPECT_EQ(default_state_file(), "/home/someone/.local/state/thermorig/page.json");
  ::unsetenv("XDG_STATE_HOME");
  ::unsetenv("HOME");
  EXPECT_EQ(default_state_file(), "");
}

}  // namespace thermorig::web
