// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/timing/read_ledger.h"

#include <gtest/gtest.h>

namespace thermorig::timing::test::reads {
namespace {

HostTime at_ms(double ms) {
  return HostTime(from_s(1e-3 * ms));
}

TEST(ReadLedger, AnAnswerToTheOnlyReadIsPlaced) {
  ReadLedger ledger;
  EXPECT_FALSE(ledger.answered(at_ms(0)));
  for (int i = 0; i < 3; ++i) {
    ledger.asked(at_ms(24 * i));
    const auto request = ledger.answered(at_ms(24 * i + 17));
    ASSERT_TRUE(request);
    EXPECT_TRUE(request->is_only);
    EXPECT_EQ(request->asked, at_ms(24 * i));
  }
}

TEST(ReadLedger, ABusyHostThatAsksBeforeItReadsDoesNotTakeTheOldAnswerForTheNewOne) {
  ReadLedger ledger;
  ledger.asked(at_ms(0));
  ledger.asked(at_ms(300));
  const auto old = ledger.answered(at_ms(302));
  ASSERT_TRUE(old);
  EXPECT_FALSE(old->is_only);
  EXPECT_EQ(old->asked, at_ms(0));
  ledger.asked(at_ms(310));  // while the second answer is on its way
  EXPECT_FALSE(ledger.answered(at_ms(317))->is_only);
  const auto newest = ledger.answered(at_ms(327));
  EXPECT_TRUE(newest->is_only);
  EXPECT_EQ(newest->asked, at_ms(310));
}

TEST(ReadLedger, AReadThatWasSentAfterTheAnswerHadBegunIsNotMeant) {
  ReadLedger ledger;
  ledger.asked(at_ms(0));
  ledger.asked(at_ms(80));
  const auto request = ledger.answered(at_ms(79));
  EXPECT_TRUE(request->is_only);
  EXPECT_EQ(request->asked, at_ms(0));
}

TEST(ReadLedger, AnAnswerThatWasLostLeavesDoubtUntilAPauseInWhichItWouldHaveCome) {
  ReadLedger ledger;
  ledger.asked(at_ms(0));  // lost
  ledger.asked(at_ms(80));
  EXPECT_FALSE(ledger.answered(at_ms(97))->is_only);
  EXPECT_TRUE(ledger.is_unsure());
  ledger.asked(at_ms(200));
  EXPECT_FALSE(ledger.is_unsure());
  EXPECT_TRUE(ledger.answered(at_ms(217))->is_only);
}

TEST(ReadLedger, WithoutSuchAPauseTheDoubtEndsAllTheSame) {
  ReadLedger ledger;
  ledger.asked(at_ms(0));  // lost
  int unsure = 0;
  for (int ms = 80; ms < 2000; ms += 24) {
    ledger.asked(at_ms(ms));
    if (!ledger.answered(at_ms(ms + 17))->is_only) ++unsure;
  }
  EXPECT_GE(unsure, 20);
  EXPECT_LE(unsure, 30);
}

}  // namespace
}  // namespace thermorig::timing::test::reads
