// SPDX-License-Identifier: MIT
#include "estimators/odometer/row_contest.h"

#include <gtest/gtest.h>

#include <memory>

#include "room.h"
#include "support/at_s.h"

namespace thermorig::odometer {
namespace {

/// The halves of a start and the gyro's path through them.
struct StoredHalves {
  explicit StoredHalves(const Room& room) {
    for (const Seen& seen : seen_in(room)) {
      for (const TimedGyro& sample : seen.gyro)
        path.add(to_s(sample.stamp.time - at_s(0.0)), double{sample.rate_dps}, 0.0);
      for (const unsigned parity : {0U, 1U}) {
        const auto half = half_of(seen.frame, parity, at_s(0.0));
        if (half && half->begin_s > path.begin_s()) store.add(*half, half->end_s);
      }
    }
  }
  HalfStore store;
  GyroPath path;
};

Room rolling_room(double rolling) {
  Room room = turning_room(25.0);
  room.angle_deg = to_and_fro(300.0, 200.0);
  room.rolling = rolling;
  return room;
}

/// What a start that went well has learnt of the gyro in the room.
Priors learnt_in(const Room& room) {
  Priors priors;
  priors.bias_dps = room.bias_dps;
  priors.bias_sigma_dps = 0.2;
  priors.scale = room.scale;
  priors.scale_sigma = 0.004;
  return priors;
}

/// All orders go through the start, one of them for the caller.
class HeardContest {
 public:
  HeardContest(const Room& room, RowOrder of_caller) : start_(room) {
    const Priors learnt = learnt_in(room);
    contest_.begin_again(of_caller, learnt, start_.store, true);
    Tracker callers(learnt, lens_);
    callers.restart(learnt, of_caller);
    for (std::size_t i = 0; i < start_.store.count(); ++i) {
      callers.advance(start_.path, start_.store.at(i).now_s);
      contest_.note(of_caller, i, callers.add(start_.store.at(i).half, start_.path));
    }
    for (int step = 0; step < 400 && !all_heard(); ++step) contest_.add(start_.store, start_.path, 90);
  }
  bool all_heard() const { return contest_.are_heard(start_.store); }
  FoundRows verdict() const { return contest_.verdict(); }
  /// As if halves had hardly differed from the map of that order.
  void make_lead(RowOrder order) {
    for (std::size_t i = 0; i < start_.store.count(); ++i)
      contest_.note(order, i, {.is_judged = true, .left_k2 = 1e-6});
  }

 private:
  StoredHalves start_;
  SharedLens lens_ = std::make_shared<const Lens>(CameraProfile());
  RowContest contest_{Priors(), lens_, false};
};

/// With rows at once for the caller's. Nothing: some are never heard.
std::optional<FoundRows> heard_in(const Room& room) {
  const HeardContest contest(room, RowOrder::at_once);
  if (!contest.all_heard()) return std::nullopt;
  return contest.verdict();
}

TEST(RowContest, HearsAllOrdersAgainOnceTheGyroIsKnown) {
  const auto first = heard_in(rolling_room(1.0)), last = heard_in(rolling_room(-1.0));
  ASSERT_TRUE(first && last);
  EXPECT_EQ(first->order, RowOrder::first_to_last);
  EXPECT_EQ(last->order, RowOrder::last_to_first);
  EXPECT_GT(first->margin, 100.0);
  EXPECT_GT(last->margin, 100.0);
}

TEST(RowContest, LetsTheCallersOrderStandWhereTheOthersAreLost) {
  const auto found = heard_in(rolling_room(0.0));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->order, RowOrder::at_once);
}

TEST(RowContest, IsWonByRowsAtOnceThoughAnOrderThatWasGivenUpHadLed) {
  Room room = rolling_room(0.0);
  room.angle_deg = to_and_fro(300.0, 325.0);  // so fast and so clear that the wrong order is given up
  room.contrast_k = 1.0;
  room.noise_k = 0.2;
  HeardContest contest(room, RowOrder::last_to_first);
  ASSERT_TRUE(contest.all_heard());
  contest.make_lead(RowOrder::first_to_last);
  EXPECT_EQ(contest.verdict().order, RowOrder::at_once);
  EXPECT_GT(contest.verdict().margin, 10.0);
}

TEST(HalfStore, ForgetsHalvesFromAnyPlaceOn) {
  StoredHalves start(rolling_room(0.0));
  const std::size_t before = start.store.count();
  const double first_s = start.store.at(0).half.begin_s, fourth_s = start.store.at(3).half.begin_s;
  start.store.forget(1, 2);
  EXPECT_EQ(start.store.count(), before - 2);
  EXPECT_EQ(start.store.at(0).half.begin_s, first_s);
  EXPECT_EQ(start.store.at(1).half.begin_s, fourth_s);
}

}  // namespace
}  // namespace thermorig::odometer
