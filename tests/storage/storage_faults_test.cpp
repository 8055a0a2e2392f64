// SPDX-License-Identifier: MIT
// Faults of the disk at any call: tests/bench/fault_table.sh does all of them.
#include <gtest/gtest.h>

#include "enumeration.h"

// libhdf5 1.10 leaks some hundred bytes where a write fails, and nobody else can free them.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libhdf5";
}

namespace thermorig::storage_test {
namespace {

#ifdef THERMORIG_FEW_POINTS
constexpr std::uint64_t points_least = 75;
const EnumerationSettings ends{.share = 0.001, .error_stride = 0, .starts = 1, .recover_stride = 1000};
const EnumerationSettings errors{
    .share = 0.0, .error_stride = 0, .error_share = 0.1, .starts = 1, .recover_stride = 1000};
#else
constexpr std::uint64_t points_least = 1000;
const EnumerationSettings ends{.share = 0.013, .error_stride = 0, .starts = 1, .recover_stride = 100};
const EnumerationSettings errors{
    .share = 0.0, .error_stride = 800, .error_share = 0.2, .starts = 2, .recover_stride = 100};
#endif

const RecordedSession& short_session() {
  static const RecordedSession recorded = record_session(60);
  return recorded;
}

std::string examples(const Enumeration& enumeration) {
  std::string text;
  for (const auto& [line, tally] : enumeration.lines)
    if (!tally.example.empty()) text += line + ": " + tally.example + "\n";
  return text;
}

TEST(StorageFaults, LoseNothingThatWasPromisedAndNothingSilently) {
  Enumeration enumeration = enumerate(record_session(200), ends);
  add(enumeration,
      enumerate(short_session(), errors));  // each of them is a recording or a recovery of its own
  EXPECT_GE(points_of(enumeration), points_least);
  EXPECT_EQ(count_of(enumeration, Outcome::silent), 0U) << examples(enumeration);
  EXPECT_EQ(count_of(enumeration, Outcome::beyond), 0U) << examples(enumeration);
  EXPECT_GT(count_of(enumeration, Outcome::loud), 0U);
}

TEST(StorageFaults, AreNoticedWhereASyncIsLeftOut) {
  for (const Mutation mutation : {Mutation::no_sync, Mutation::no_folder_sync}) {
    EnumerationSettings settings = ends;
    settings.mutation = mutation;
    EXPECT_GT(count_of(enumerate(short_session(), settings), Outcome::silent), 0U);
  }
}

}  // namespace
}  // namespace thermorig::storage_test
