// SPDX-License-Identifier: MIT
#include "thermorig/io/files/whole_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <functional>
#include <iterator>

#include "session/temporary_folder.h"
#include "support/as_nobody.h"
#include "support/file_text.h"
#include "thermorig/core/error.h"

namespace thermorig::files {
namespace {

namespace fs = std::filesystem;

class WholeFile : public session::InTemporaryFolder {};
class PartFileName : public session::InTemporaryFolder {};

std::size_t entries_in(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

/// "code: what", "" if nothing is refused.
std::string refusal_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return std::to_string(static_cast<int>(error.code())) + ": " + error.what_happened();
  }
  return "";
}

TEST_F(WholeFile, ComesBackAsItWasWritten) {
  const fs::path file = folder_ / "a.bin";
  const std::string bytes("a\0b\n\xff", 5);
  write_whole(file, bytes, "the model");
  const auto read = read_whole(file, 5, "the model");
  EXPECT_EQ(std::string(read.begin(), read.end()), bytes);
  EXPECT_EQ(entries_in(folder_), 1U);
}

TEST_F(WholeFile, TakesThePlaceOfAnOlderOne) {
  const fs::path file = folder_ / "a.bin";
  write_whole(file, "the longer text of before", "the model");
  write_whole(file, "new", "the model");
  EXPECT_EQ(tests::file_text(file), "new");
}

TEST_F(WholeFile, IsLeftAloneWhereTheNewOneFails) {
  const fs::path file = folder_ / "a.bin";
  write_whole(file, "old", "the model");
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{1000, before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ::setrlimit(RLIMIT_FSIZE, &small);
  const std::string refusal = refusal_of([&] { write_whole(file, std::string(5000, 'x'), "the model"); });
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(refusal, "7: cannot write the model (4000 bytes missing): File too large");
  EXPECT_EQ(tests::file_text(file), "old");
  EXPECT_EQ(entries_in(folder_), 1U);
}

TEST_F(WholeFile, IsNotWrittenOverAFolderOrIntoNone) {
  EXPECT_EQ(refusal_of([&] { write_whole(folder_, "x", "the model"); }),
            "7: cannot write the model: the name is taken by a folder, a pipe or a device");
  EXPECT_EQ(refusal_of([&] { write_whole("/dev/null", "x", "the model"); }),
            "7: cannot write the model: the name is taken by a folder, a pipe or a device");
  EXPECT_EQ(refusal_of([&] { write_whole(folder_ / "none" / "a.bin", "x", "the model"); }),
            "7: cannot create the model: No such file or directory");
}

TEST_F(WholeFile, IsNotReadWhereItIsMissingTooLargeOrNoFile) {
  const fs::path file = folder_ / "a.bin", pipe = folder_ / "pipe";
  const auto read = [](const fs::path& from) {
    return refusal_of([&] { read_whole(from, 100, "the model"); });
  };
  write_whole(file, std::string(101, 'x'), "the model");
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(read(file),
            "8: cannot read the model: it has 101 bytes, more than the 100 that are read at most");
  EXPECT_EQ(read(folder_ / "none"), "8: cannot read the model: No such file or directory");
  EXPECT_EQ(read(folder_), "8: cannot read the model: it is a folder");
  EXPECT_EQ(read(pipe), "8: cannot read the model: it is a pipe or a device, not a regular file");
  EXPECT_EQ(read("/dev/zero"), "8: cannot read the model: it is a pipe or a device, not a regular file");
}

TEST_F(PartFileName, DoesNotTakeANameThatIsThere) {
  const fs::path file = folder_ / "a.bin";
  write_whole(file, "old", "the model");
  EXPECT_EQ(refusal_of([&] {
              PartFile part(file, "the model");
              part.publish();
            }),
            "7: cannot name the model: File exists");
  EXPECT_EQ(tests::file_text(file), "old");
  EXPECT_EQ(entries_in(folder_), 1U);
}

TEST_F(WholeFile, IsWrittenOnceByThoseWhoLeaveTheFirst) {
  const fs::path file = folder_ / "a.bin";
  EXPECT_TRUE(write_whole_if_free(file, "first", "the result"));
  EXPECT_FALSE(write_whole_if_free(file, "second", "the result"));
  EXPECT_EQ(tests::file_text(file), "first");
  EXPECT_EQ(entries_in(folder_), 1U);
  EXPECT_EQ(refusal_of([&] { write_whole_if_free(folder_ / "none" / "a.bin", "x", "the result"); }),
            "7: cannot create the result: No such file or directory");
}

TEST_F(WholeFile, ThatMayNotBeReadIsNoDamagedOne) {
  const fs::path file = folder_ / "a.bin";
  write_whole(file, "x", "the model");
  fs::permissions(folder_, fs::perms::all);
  fs::permissions(file, fs::perms::owner_write);
  EXPECT_EQ(tests::code_as_nobody([&] { read_whole(file, 5, "the model"); }), 6);
}

TEST_F(PartFileName, SaysWhoseItIs) {
  const fs::path file = folder_ / "a.bin";
  const std::string host = host_name(), path = file.string();
  EXPECT_EQ(part_path_of(file), path + "." + host + "." + std::to_string(::getpid()) + ".part");
  EXPECT_EQ(left_part_of(part_path_of(file)), file) << "of a process before this one";
  constexpr const char* unused = "1073741823";  // more than the system gives
  EXPECT_EQ(left_part_of(path + "." + host + "." + unused + ".part"), file);
  for (const std::string& other :
       {path, path + ".part", path + "..part", path + ".77.part", path + "." + host + ".x77.part",
        path + "." + host + ".77x.part", path + "." + host + ".77.", path + "." + host + ".77",
        path + ".another-host.77.part", path + "." + host + ".part", path + "." + host + "..part",
        path + "." + host + ".-77.part", path + "." + host + ".99999999999999999999.part",
        path + "." + host + ".1.part"})  // the system's first process runs
    EXPECT_EQ(left_part_of(other), std::nullopt) << other;
}

TEST_F(PartFileName, IsNotTakenFromAProgramThatWritesIt) {
  const fs::path file = folder_ / "a.bin";
  const PartFile part(file, "the model");
  EXPECT_FALSE(remove_unless_held(part_path_of(file)));
  EXPECT_FALSE(remove_unless_held(folder_ / "none"));
  std::ofstream(folder_ / "left.part") << "x";
  EXPECT_TRUE(remove_unless_held(folder_ / "left.part"));
  EXPECT_EQ(entries_in(folder_), 1U);
}

}  // namespace
}  // namespace thermorig::files
