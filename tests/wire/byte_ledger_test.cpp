// SPDX-License-Identifier: MIT
#include "thermorig/sensors/wire/byte_ledger.h"

#include <gtest/gtest.h>

namespace thermorig::test {
namespace {

TEST(ByteLedger, BooksGapsInsideADamagedMessageAsDamaged) {
  wire::ByteLedger ledger;
  ledger.receive(100);
  ledger.mark_damage(30);
  ledger.book_gap(10);
  EXPECT_TRUE(ledger.in_damage());
  ledger.book_gap(40);
  EXPECT_FALSE(ledger.in_damage());
  EXPECT_EQ(ledger.counters.bytes_in_damaged, 30U);
  EXPECT_EQ(ledger.counters.bytes_skipped, 20U);
  EXPECT_EQ(ledger.counters.bytes_pending, 50U);
  EXPECT_EQ(ledger.counters.resyncs, 1U);
}

TEST(ByteLedger, EndsTheDamageAtAGoodMessage) {
  wire::ByteLedger ledger;
  ledger.receive(100);
  ledger.mark_damage(80);
  ledger.book_gap(10);
  EXPECT_EQ(ledger.book_message(20), (StreamSpan{10, 30}));
  ledger.book_gap(5);
  EXPECT_EQ(ledger.counters.bytes_in_damaged, 10U);
  EXPECT_EQ(ledger.counters.bytes_skipped, 5U);
  EXPECT_EQ(ledger.counters.resyncs, 2U);
}

TEST(ByteLedger, TellsOfAGapOnceAndOfFillerNever) {
  wire::ByteLedger ledger;
  ledger.receive(10);
  ledger.book_filler(2);
  EXPECT_FALSE(ledger.take_gap());
  ledger.book_gap(3);
  EXPECT_TRUE(ledger.take_gap());
  EXPECT_FALSE(ledger.take_gap());
  EXPECT_EQ(ledger.counters.bytes_skipped, 5U);
}

}  // namespace
}  // namespace thermorig::test
