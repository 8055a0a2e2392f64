// SPDX-License-Identifier: MIT
#include "thermorig/learning/study/shard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "small_study.h"

namespace thermorig::study {
namespace {

using testing::HasSubstr;

class Shards : public SmallStudy {};

TEST_F(Shards, HoldEachJobOnceHoweverManyThereAre) {
  const std::vector<Job> all = jobs();
  for (int count = 1; count <= 12; ++count) {
    std::multiset<std::string> seen;
    std::size_t least = all.size(), most = 0;
    for (int index = 1; index <= count; ++index) {
      const std::vector<Job> shard = jobs_of(Shard{index, count}, all);
      for (const Job& job : shard) seen.insert(id_of(job));
      least = std::min(least, shard.size());
      most = std::max(most, shard.size());
    }
    EXPECT_EQ(seen.size(), all.size()) << count;
    EXPECT_EQ(std::set<std::string>(seen.begin(), seen.end()).size(), all.size()) << count;
    EXPECT_LE(most - least, 1U) << count;
  }
}

TEST_F(Shards, TakeEveryNthJobFromTheirOwnOn) {
  const std::vector<Job> all = jobs(), shard = jobs_of(Shard{2, 3}, all);
  EXPECT_EQ(shard, (std::vector{all[1], all[4], all[7]}));
  EXPECT_TRUE(jobs_of(Shard{9, 9}, all).empty());
}

Error refusal_of(const std::string& text) {
  try {
    shard_from(text);
  } catch (const Error& error) {
    return error;
  }
  return {ExitCode::ok, "", "", ""};
}

TEST(Shard, IsReadFromItsNumberAndHowManyThereAre) {
  EXPECT_EQ(shard_from("1/1").count, 1);
  EXPECT_EQ(shard_from("3/8").index, 3);
  EXPECT_EQ(shard_from("3/8").count, 8);
}

TEST(Shard, CountsFromOne) {
  for (const char* const text : {"0/8", "9/8", "-1/8"}) {
    EXPECT_EQ(refusal_of(text).code(), ExitCode::bad_usage) << text;
    EXPECT_THAT(refusal_of(text).what_happened(), HasSubstr("count from 1")) << text;
    EXPECT_THAT(refusal_of(text).advice(), HasSubstr("--array=1-8")) << text;
  }
}

TEST(Shard, IsNothingElse) {
  for (const char* const text :
       {"", "/", "3", "3/", "/8", "3/0", "1/-2", "3 / 8", "3/8/2", "a/b", "1.5/2", "+1/2", "1/99999999999"})
    EXPECT_THAT(refusal_of(text).what_happened(), HasSubstr("is not a part of a study")) << text;
}

class JobIds : public SmallStudy {};

TEST_F(JobIds, AreTheNamesOfTheResults) {
  for (const Job& job : jobs()) EXPECT_EQ(id_of(job) + ".json", file_name_of(job));
}

}  // namespace
}  // namespace thermorig::study
