// SPDX-License-Identifier: MIT
#include "thermorig/io/files/claim.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <map>
#include <random>
#include <set>
#include <thread>

#include "io/files/claim_text.h"
#include "session/temporary_folder.h"
#include "support/file_text.h"
#include "thermorig/core/error.h"

namespace thermorig::files {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;
using Time = std::chrono::steady_clock::time_point;

const Process node7{"node7", "0123-4567", 9, 4711, 500};

class ClaimFile : public session::InTemporaryFolder {
 protected:
  void SetUp() override {
    InTemporaryFolder::SetUp();
    name_ = folder_ / "job-1";
  }

  fs::path file(int number) const { return fmt::format("{}.claim.{}", name_.string(), number); }

  /// As a program of another machine leaves it.
  void claim_elsewhere(int number, const std::string& signs_of_life = "") const {
    std::ofstream(file(number)) << claim_text(node7, "2026-11-24T03:49:01Z") << signs_of_life;
  }

  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), {}));
  }

  fs::path name_;
};

TEST_F(ClaimFile, IsFreeBeforeAnybodyHasIt) {
  EXPECT_TRUE(look_at_claim(name_).is_free());
  EXPECT_TRUE(claimed_names(folder_).empty());
  EXPECT_TRUE(claimed_names(folder_ / "none").empty());
}

TEST_F(ClaimFile, SaysWhoHasIt) {
  const auto claim = Claim::take(name_, {});
  ASSERT_TRUE(claim);
  const ClaimSight seen = look_at_claim(name_);
  EXPECT_FALSE(seen.is_free());
  EXPECT_EQ(seen.number, 1);
  EXPECT_EQ(seen.holder, this_process());
  EXPECT_THAT(text_of(seen), testing::MatchesRegex(".+, process [0-9]+, since [0-9]{4}-..-..T..:..:..Z"));
  EXPECT_EQ(claimed_names(folder_), std::vector{name_});
}

TEST_F(ClaimFile, OfAnotherMachineIsNamed) {
  claim_elsewhere(1, "...");
  EXPECT_EQ(text_of(look_at_claim(name_)), "node7, process 4711, since 2026-11-24T03:49:01Z");
}

TEST_F(ClaimFile, GrowsWithEachSignOfLife) {
  auto claim = Claim::take(name_, {});
  const std::uint64_t before = look_at_claim(name_).bytes;
  claim->beat();
  claim->beat();
  EXPECT_EQ(look_at_claim(name_).bytes, before + 2);
  EXPECT_EQ(look_at_claim(name_).holder, this_process());
}

TEST_F(ClaimFile, IsTakenByOneOfThoseWhoSawTheSame) {
  const ClaimSight seen = look_at_claim(name_);
  const auto first = Claim::take(name_, seen), second = Claim::take(name_, seen);
  EXPECT_TRUE(first);
  EXPECT_FALSE(second);
  EXPECT_FALSE(first->is_taken_over());
}

TEST_F(ClaimFile, IsFreeAgainOnceItWasGivenUp) {
  auto claim = Claim::take(name_, {});
  claim->beat();
  claim->give_up();
  const ClaimSight seen = look_at_claim(name_);
  EXPECT_TRUE(seen.is_free());
  EXPECT_EQ(seen.number, 1);
  EXPECT_TRUE(Claim::take(name_, seen));
  EXPECT_EQ(look_at_claim(name_).number, 2);
}

TEST_F(ClaimFile, ThatWasTakenOverShowsItsHolder) {
  auto slow = Claim::take(name_, {});
  const auto taker = Claim::take(name_, look_at_claim(name_));
  ASSERT_TRUE(taker);
  EXPECT_TRUE(slow->is_taken_over());
  slow->beat();     // into its own file, which nobody looks at any more
  slow->give_up();  // as well
  slow->remove();   // not its own any more
  EXPECT_FALSE(look_at_claim(name_).is_free());
  EXPECT_EQ(look_at_claim(name_).number, 2);
}

TEST_F(ClaimFile, CannotBeTakenByOneWhoSawItBeforeAnotherTookItOver) {
  claim_elsewhere(1);
  const ClaimSight stale = look_at_claim(name_);
  auto first = Claim::take(name_, stale);
  ASSERT_TRUE(first);
  EXPECT_FALSE(Claim::take(name_, stale));
  first->give_up();
  EXPECT_FALSE(Claim::take(name_, stale));  // must look again
}

TEST_F(ClaimFile, IsGoneWithAllBeforeItWhenItsWorkIsDone) {
  claim_elsewhere(1);
  claim_elsewhere(2);
  auto claim = Claim::take(name_, look_at_claim(name_));
  EXPECT_EQ(files(), 3U);
  claim->remove();
  EXPECT_EQ(files(), 0U);
  claim_elsewhere(1);
  claim_elsewhere(2);
  remove_claim(name_);
  EXPECT_EQ(files(), 0U);
}

TEST_F(ClaimFile, OfWhichAKillLeftHalfHasNoNameButCounts) {
  const std::string whole = claim_text(node7, "2026-11-24T03:49:01Z");
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
    std::ofstream(file(1)) << whole.substr(0, bytes);
    const ClaimSight seen = look_at_claim(name_);
    EXPECT_FALSE(seen.is_free());
    EXPECT_FALSE(seen.holder) << bytes;
  }
  EXPECT_EQ(text_of(look_at_claim(name_)), "a program that has not named itself yet");
}

TEST_F(ClaimFile, OfAStrangerIsReadNoFurtherThanItIsAClaim) {
  const std::string whole = claim_text(node7, "2026-11-24T03:49:01Z");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    return text.replace(text.find(from), from.size(), to);
  };
  for (const std::string& text :
       {std::string(5'000'000, 'x'), with("claim 1", "claim 2"), with("node7", ""), with("node7", "\x1b[2J"),
        with("node7", "a b"), with("node7", std::string(65, 'n')), with("4711", "-1"), with("4711", "4711x"),
        with("4711", "99999999999999999999999"), with("since", "hence"), with("03:49", "03\t49")}) {
    std::ofstream(file(1)) << text;
    EXPECT_FALSE(look_at_claim(name_).holder) << text.substr(0, 200);
  }
}

TEST_F(ClaimFile, ThatIsAFolderIsRefused) {
  for (int number = 1; number <= 3; ++number) std::ofstream(file(number)) << "x";
  EXPECT_EQ(look_at_claim(name_).number, 3);
  fs::create_directory(file(4));
  EXPECT_THROW(look_at_claim(name_), Error);
}

/// Nobody waits for ever for what nobody holds.
TEST_F(ClaimFile, ThatIsALinkToNothingIsRefused) {
  fs::create_symlink("nowhere", file(1));
  EXPECT_THROW(Claim::take(name_, look_at_claim(name_)), Error);
  EXPECT_THROW(take_alone(name_, "works on it", "wait"), Error);
}

TEST_F(ClaimFile, ThatCannotBeMadeSaysWhy) {
  try {
    Claim::take(folder_ / "none" / "job", {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::storage);
    EXPECT_THAT(error.what_happened(), testing::HasSubstr("cannot make a claim: No such file"));
  }
}

TEST_F(ClaimFile, ThatTheDiskDoesNotTakeIsGivenUp) {
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{20, before.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ::setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_THROW(Claim::take(name_, {}), Error);
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_FALSE(look_at_claim(name_).holder);
}

/// Looks at a claim by a clock that is moved by hand.
class WatchedClaim : public ClaimFile {
 protected:
  bool is_still_after(std::chrono::steady_clock::duration step) {
    now_ += step;
    return watch_.is_still(look_at_claim(name_), now_);
  }

  ClaimWatch watch_{{.beat = seconds(5), .patience = seconds(60)}};
  Time now_ = Time(std::chrono::hours(1));
};

TEST_F(WatchedClaim, IsStillAfterAMinuteOfLookingInVain) {
  claim_elsewhere(1);
  EXPECT_FALSE(is_still_after(seconds(0)));
  for (int i = 1; i < 24; ++i) EXPECT_FALSE(is_still_after(milliseconds(2'500))) << i;
  EXPECT_TRUE(is_still_after(milliseconds(2'500)));
}

TEST_F(WatchedClaim, IsNeverStillWhileItGrows) {
  std::string signs;
  for (int i = 0; i < 50; ++i) {
    claim_elsewhere(1, signs += ".");
    for (int look = 0; look < 11; ++look) EXPECT_FALSE(is_still_after(seconds(5)));
  }
}

TEST_F(WatchedClaim, IsLookedAtAnewWhenAnotherHasIt) {
  claim_elsewhere(1);
  for (int i = 0; i < 12; ++i) is_still_after(seconds(5));
  claim_elsewhere(2);
  EXPECT_FALSE(is_still_after(seconds(5)));
  for (int i = 1; i < 12; ++i) EXPECT_FALSE(is_still_after(seconds(5)));
  EXPECT_TRUE(is_still_after(seconds(5)));
}

TEST_F(WatchedClaim, IsNotStillBecauseTheWatcherStoodStill) {
  claim_elsewhere(1);
  is_still_after(seconds(0));
  EXPECT_FALSE(is_still_after(std::chrono::hours(8)));  // a computer that slept, a disk that hung
  claim_elsewhere(1, ".");
  EXPECT_FALSE(is_still_after(seconds(5)));
}

TEST_F(WatchedClaim, OfAProcessThatEndedHereIsStaleAtOnce) {
  Process ended = this_process();
  ++ended.start;
  std::ofstream(file(1)) << claim_text(ended, "2026-11-24T03:49:01Z");
  EXPECT_TRUE(is_stale(look_at_claim(name_), watch_, now_));
  claim_elsewhere(2);
  EXPECT_FALSE(is_stale(look_at_claim(name_), watch_, now_));
}

TEST_F(ClaimFile, GivesSignsOfLifeByItself) {
  std::uint64_t before = 0;
  {
    BeatingClaim claim(*Claim::take(name_, {}), {.beat = milliseconds(1)});
    before = look_at_claim(name_).bytes;
    while (look_at_claim(name_).bytes < before + 3) std::this_thread::yield();
    EXPECT_FALSE(claim.is_taken_over());
    auto taker = Claim::take(name_, look_at_claim(name_));
    while (!claim.is_taken_over()) std::this_thread::yield();
    taker->remove();
  }
  EXPECT_EQ(files(), 0U);
  { const BeatingClaim claim(*Claim::take(name_, {})); }
  EXPECT_TRUE(look_at_claim(name_).given_up);
  {
    BeatingClaim claim(*Claim::take(name_, look_at_claim(name_)));
    claim.remove();
  }
  EXPECT_EQ(files(), 0U);
}

/// What take_alone() refuses, "" if it gets the claim.
std::string refusal_of(const fs::path& name, const ClaimTiming& timing = {}) {
  try {
    take_alone(name, "trains here", "wait", timing);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::no_permission);
    EXPECT_EQ(error.where(), name.parent_path().string());
    return error.what_happened();
  }
  return "";
}

TEST_F(ClaimFile, ForOneProgramAloneIsRefusedToOthersWhileItsHolderRuns) {
  const auto claim = Claim::take(name_, {});
  EXPECT_EQ(refusal_of(name_), text_of(look_at_claim(name_)) + " trains here");
}

TEST_F(ClaimFile, ForOneProgramAloneIsHadOnceItIsFreeOrStale) {
  EXPECT_EQ(refusal_of(name_), "");
  EXPECT_EQ(look_at_claim(name_).number, 1);
  claim_elsewhere(2);
  EXPECT_EQ(refusal_of(name_, {.beat = milliseconds(4), .patience = milliseconds(20)}), "");
  EXPECT_EQ(look_at_claim(name_).number, 3);
}

TEST_F(ClaimFile, ForOneProgramAloneIsRefusedAtTheFirstSignOfLife) {
  claim_elsewhere(1);
  std::atomic<bool> refused = false;
  std::jthread holder([&] {
    for (std::string signs = "."; !refused; signs += ".") {
      claim_elsewhere(1, signs);
      std::this_thread::sleep_for(milliseconds(1));
    }
  });
  EXPECT_THAT(refusal_of(name_, {.beat = milliseconds(4), .patience = std::chrono::hours(1)}),
              testing::EndsWith("trains here"));
  refused = true;
}

TEST_F(ClaimFile, IsTakenOverByOneOfManyThreads) {
  for (int round = 1; round <= 50; ++round) {
    const ClaimSight seen = look_at_claim(name_);
    std::atomic<int> winners = 0;
    std::vector<std::jthread> takers;
    for (int i = 0; i < 8; ++i)
      takers.emplace_back([&] {
        if (Claim::take(name_, seen)) ++winners;
      });
    takers.clear();
    EXPECT_EQ(winners, 1);
    EXPECT_EQ(look_at_claim(name_).number, round);
  }
}

/// Programs that take a claim, work under it, and are killed at any instant. A work's begin and end are lines
/// of a file that all append to.
class KilledClaim : public ClaimFile {
 protected:
  /// Never returns.
  [[noreturn]] void work_again_and_again(int program) const {
    std::mt19937 random(static_cast<unsigned>(program));
    // Longer than a sync takes on a busy disk: who stands still so long may be taken over.
    ClaimWatch watch({.beat = milliseconds(500), .patience = seconds(15)});
    while (true) {
      const ClaimSight seen = look_at_claim(name_);
      if (seen.is_free() || is_stale(seen, watch, std::chrono::steady_clock::now()))
        if (auto claim = Claim::take(name_, seen)) {
          tell(fmt::format("begin {}\n", program));
          for (int beats = static_cast<int>(random() % 4); beats > 0; --beats) claim->beat();
          tell(fmt::format("end {}\n", program));
          claim->give_up();
        }
      std::this_thread::sleep_for(std::chrono::microseconds(random() % 500));
    }
  }

  void tell(const std::string& line) const { std::ofstream(folder_ / "work", std::ios::app) << line; }

  pid_t start(int program) const {
    const pid_t child = ::fork();
    if (child == 0) work_again_and_again(program);
    return child;
  }

  void start_another() { programs_[next_] = start(next_), ++next_; }

  void kill_one(int program) {
    killed_.insert(program);
    ::kill(programs_[program], SIGKILL);
    ::waitpid(programs_[program], nullptr, 0);
    programs_.erase(program);
  }

  /// Works that lay over another's, and works that ended. Those of the killed may lie under one: who takes
  /// over sees that they are dead.
  std::pair<int, int> counted() const {
    std::ifstream work(folder_ / "work");
    std::string word;
    int program = 0, working = -1, overlaps = 0, ended = 0;
    while (work >> word >> program) {
      if (word == "begin" && working != -1 && !killed_.contains(working)) ++overlaps;
      if (word == "end" && working != program) ++overlaps;
      if (word == "end") ++ended;
      working = word == "begin" ? program : -1;
    }
    return {overlaps, ended};
  }

  std::map<int, pid_t> programs_;  // that run
  std::set<int> killed_;
  int next_ = 0;
};

TEST_F(KilledClaim, NeverHasTwoHoldersAndNeverNone) {
  std::mt19937 random(7);
  while (next_ < 4) start_another();
  for (int kill = 0; kill < 60; ++kill) {
    std::this_thread::sleep_for(std::chrono::microseconds(5'000 + random() % 10'000));
    kill_one(std::next(programs_.begin(), static_cast<std::ptrdiff_t>(random() % programs_.size()))->first);
    start_another();
  }
  const auto before = counted().second;
  const auto has_gone_on = [&] { return counted().second > before; };
  for (int i = 0; i < 8'000 && !has_gone_on(); ++i) std::this_thread::sleep_for(milliseconds(5));
  EXPECT_TRUE(has_gone_on());  // whatever the last kill left, the claim is had again
  while (!programs_.empty()) kill_one(programs_.begin()->first);
  EXPECT_EQ(counted().first, 0);
}

}  // namespace
}  // namespace thermorig::files
