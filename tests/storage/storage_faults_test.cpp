// SPDX-License-Identifier: MIT
// Faults of the disk at any call: tests/bench/fault_table.sh does all of them.
#include <gtest/gtest.h>

#include "enumeration.h"

namespace thermorig::storage_test {
namespace {

const RecordedSession& long_session() {
  static const RecordedSession recorded = record_session(200);
  return recorded;
}

#ifdef THERMORIG_FEW_POINTS
constexpr std::uint64_t points_least = 300;
EnumerationSettings some_points() {
  return {.share = 0.004, .error_stride = 0, .starts = 1, .recover_stride = 1000};
}
#else
constexpr std::uint64_t points_least = 2500;
EnumerationSettings some_points() {
  return {.share = 0.02, .error_stride = 800, .starts = 2, .recover_stride = 100};
}
#endif

std::string examples(const Enumeration& enumeration) {
  std::string text;
  for (const auto& [line, tally] : enumeration.lines)
    if (!tally.example.empty()) text += line + ": " + tally.example + "\n";
  return text;
}

TEST(StorageFaults, LoseNothingThatWasPromisedAndNothingSilently) {
  const Enumeration enumeration = enumerate(long_session(), some_points());
  EXPECT_GE(points_of(enumeration), points_least);
  EXPECT_EQ(count_of(enumeration, Outcome::silent), 0U) << examples(enumeration);
  EXPECT_EQ(count_of(enumeration, Outcome::beyond), 0U) << examples(enumeration);
  EXPECT_GT(count_of(enumeration, Outcome::loud), 0U);
}

TEST(StorageFaults, AreNoticedWhereASyncIsLeftOut) {
  EnumerationSettings settings = some_points();
  settings.share = 0.01;
  settings.error_stride = 0;
  settings.starts = 1;
  settings.mutation = Mutation::no_sync;
  EXPECT_GT(count_of(enumerate(long_session(), settings), Outcome::silent), 0U);
  settings.mutation = Mutation::no_folder_sync;
  EXPECT_GT(count_of(enumerate(long_session(), settings), Outcome::silent), 0U);
}

}  // namespace
}  // namespace thermorig::storage_test
