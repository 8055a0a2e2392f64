// SPDX-License-Identifier: MIT
#include "thermorig/io/files/process.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "session/temporary_folder.h"

namespace thermorig::files {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t never_a_process = 1ULL << 30U;  // beyond the most that the kernel gives (2^22)

TEST(Process, OfOurOwnHasAllThatTellsItApart) {
  const Process own = this_process();
  EXPECT_THAT(own.host, testing::MatchesRegex("[A-Za-z0-9._-]+"));
  EXPECT_EQ(own.boot.size(), 36U);
  EXPECT_GT(own.space, 0U);
  EXPECT_EQ(own.number, static_cast<std::uint64_t>(::getpid()));
  EXPECT_GT(own.start, 0U);
  EXPECT_EQ(this_process(), own);
}

TEST(Process, HasNotEndedWhileItRuns) {
  EXPECT_EQ(life_of(this_process()), Life::runs);
  EXPECT_FALSE(has_ended(this_process()));
}

TEST(Process, HasEndedWhereItsNumberIsUnusedOrAnotherOnes) {
  Process process = this_process();
  process.number = never_a_process;
  EXPECT_TRUE(has_ended(process));
  process = this_process();
  ++process.start;
  EXPECT_TRUE(has_ended(process));
}

TEST(Process, OfAnotherMachineStartOrSpaceIsNotKnownToHaveEnded) {
  Process dead = this_process();
  dead.number = never_a_process;
  Process host = dead, boot = dead, space = dead;
  host.host = "another";
  boot.boot = "another";
  ++space.space;
  for (const Process& process : {host, boot, space}) EXPECT_EQ(life_of(process), Life::unknown);
  dead.number = 0;
  EXPECT_FALSE(has_ended(dead));
}

/// What the system tells of processes, made.
class ToldProcess : public session::InTemporaryFolder {
 protected:
  void SetUp() override {
    InTemporaryFolder::SetUp();
    fs::create_directories(folder_ / "sys/kernel/random");
    fs::create_directories(folder_ / "self/ns");
    std::ofstream(folder_ / "sys/kernel/random/boot_id") << "0123-4567\n";
    fs::create_symlink("pid:[4026531836]", folder_ / "self/ns/pid");
  }

  void tell(std::uint64_t number, const std::string& stat) const {
    fs::create_directories(folder_ / std::to_string(number));
    std::ofstream(folder_ / std::to_string(number) / "stat") << stat;
  }

  Process process(std::uint64_t number, std::uint64_t start) const {
    return {this_process().host, "0123-4567", 4026531836, number, start};
  }
};

const std::string fields_between = " 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 ";

TEST_F(ToldProcess, MayHaveAnyName) {
  tell(77, "77 (a) Z 1 (b) ) S" + fields_between + "500 21\n");
  EXPECT_FALSE(has_ended(process(77, 500), folder_));
  EXPECT_TRUE(has_ended(process(77, 501), folder_));
  tell(77, "77 (a) Z" + fields_between + "500 21\n");
  EXPECT_TRUE(has_ended(process(77, 500), folder_));
}

TEST_F(ToldProcess, ThatIsHiddenButThereHasNotEnded) {
  const auto own = static_cast<std::uint64_t>(::getpid());
  EXPECT_FALSE(has_ended(process(own, 5), folder_));
  tell(own, "no such line");
  EXPECT_FALSE(has_ended(process(own, 5), folder_));
}

TEST_F(ToldProcess, OfASystemThatTellsNothingIsNotKnownToHaveEnded) {
  fs::remove(folder_ / "sys/kernel/random/boot_id");
  EXPECT_FALSE(has_ended(process(never_a_process, 1), folder_));
  EXPECT_EQ(this_process(folder_).boot, "");
  EXPECT_EQ(this_process(folder_).start, 0U);
  EXPECT_EQ(this_process("/none").space, 0U);
}

}  // namespace
}  // namespace thermorig::files
