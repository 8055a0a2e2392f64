// SPDX-License-Identifier: MIT
#include "estimators/odometer/gyro_search.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "room.h"
#include "support/at_s.h"

namespace thermorig::odometer {
namespace {

constexpr double to_judge_s = 17.0;  // 136 halves, and a second to search in them

/// What a search finds, half after half, while a rig turns in rooms one after the other, each from the first
/// half on.
class Searched {
 public:
  explicit Searched(const CameraProfile& camera = CameraProfile())
      : search_(Priors(), std::make_shared<const Lens>(camera), false) {}

  void turn_in(const Room& room) { look_at(seen_in(room), room.duration_s); }
  void look_at(const std::vector<Seen>& all, double duration_s) {
    store_.clear();
    for (const Seen& seen : all) {
      for (const TimedGyro& sample : seen.gyro)
        path_.add(begun_s_ + to_s(sample.stamp.time - at_s(0.0)), double{sample.rate_dps}, 0.0);
      auto half = half_of(seen.frame, seen.frame.fresh_even > 0 ? 0U : 1U, at_s(0.0));
      if (!half) continue;
      half->begin_s += begun_s_;
      half->end_s += begun_s_;
      if (half->begin_s < path_.begin_s()) continue;
      store_.add(*half, half->end_s);
      search_.add(store_, path_);
      found_.push_back(search_.found());
    }
    begun_s_ += duration_s;
  }
  const std::optional<Priors>& last() const { return found_.back(); }
  const FoundRows& rows() const { return search_.rows(); }
  /// After so many halves, of all.
  const std::optional<Priors>& after(std::size_t halves) const { return found_.at(halves - 1); }
  std::size_t halves() const { return found_.size(); }
  void clear() {
    search_.clear();
    found_.push_back(search_.found());
  }

 private:
  GyroSearch search_;
  TurnPath path_;
  HalfStore store_;
  double begun_s_ = 0.0;
  std::vector<std::optional<Priors>> found_;
};

void expect_right(const std::optional<Priors>& found, const Room& room) {
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->bias_dps, room.bias_dps, 1.0);
  EXPECT_NEAR(found->scale, room.scale, 0.02);
  EXPECT_NEAR(found->bias_dps, room.bias_dps, 3.0 * found->bias_sigma_dps);
  EXPECT_NEAR(found->scale, room.scale, 3.0 * found->scale_sigma);
}

TEST(GyroSearch, NamesBiasAndScaleTogetherBeforeFaintWalls) {
  for (unsigned walls = 1; walls < 9; ++walls) {
    Room room = turning_room(to_judge_s);
    room.contrast_k = 0.3;
    room.walls = walls;
    room.scale = 0.97;
    room.bias_dps = -12.0;
    Searched searched;
    searched.turn_in(room);
    expect_right(searched.last(), room);
  }
}

/// The camera's times are those of the last row.
TEST(GyroSearch, NamesThemInWhicheverOrderRowsAreExposedAndTellsIt) {
  for (const double rolling : {-1.0, 0.0, 1.0}) {
    Room room = turning_room(20.0);
    room.angle_deg = [](double time_s) {  // 190 deg/s, to and fro
      return 285.0 - 190.0 * std::abs(std::fmod(time_s, 6.0) - 3.0);
    };
    room.rolling = rolling;
    Searched searched;
    searched.turn_in(room);
    expect_right(searched.last(), room);
    EXPECT_EQ(searched.rows().order, rows_of(room));
    EXPECT_GT(searched.rows().margin, 2.0 * FoundRows::least_margin);
    EXPECT_NEAR(searched.last()->latency_s, room.latency_s + 0.0625 * std::abs(rolling), 0.015);
  }
}

/// Which shears its images as rows do that are exposed one after the other, but to one side only.
TEST(GyroSearch, TakesACameraThatRollsForOneWhoseRowsAreExposedAtOnce) {
  for (const double roll_deg : {-4.0, 4.0}) {
    Room room = turning_room(to_judge_s);
    room.roll_deg = roll_deg;
    Searched searched;
    searched.turn_in(room);
    EXPECT_EQ(searched.rows().order, RowOrder::at_once);
    EXPECT_GT(searched.rows().margin, FoundRows::least_margin) << roll_deg;
  }
}

TEST(GyroSearch, TellsNoOrderOfRowsAtRest) {
  Searched searched;
  searched.turn_in(with_rest(turning_room(0.0), 0.0, 20.0));
  EXPECT_EQ(searched.rows(), FoundRows());
}

TEST(GyroSearch, AsksNoImagesForAnOrderOfRowsThatWasMeasured) {
  Room room = turning_room(to_judge_s);
  CameraProfile camera;
  camera.row_spread = 0.3;
  Searched searched(camera);
  searched.turn_in(room);
  EXPECT_EQ(searched.rows(), (FoundRows{RowOrder::first_to_last, 0.0}));
}

TEST(GyroSearch, KnowsTheBiasOfARigThatRestsAndNotItsScale) {
  Searched searched;
  searched.turn_in(with_rest(turning_room(0.0), 0.0, 10.0));
  ASSERT_TRUE(searched.last());
  EXPECT_NEAR(searched.last()->bias_dps, 4.0, 1.0);
  EXPECT_GE(searched.last()->scale_sigma, 0.02);
}

/// At one speed many biases and scales do, and the search keeps few of them.
TEST(GyroSearch, NamesACovarianceThatItsDeviationsAllow) {
  for (unsigned walls = 1; walls < 5; ++walls) {
    Room room = turning_room(20.0);
    room.angle_deg = [](double time_s) { return 150.0 * time_s; };
    room.walls = walls;
    Searched searched;
    searched.turn_in(room);
    for (std::size_t half = 1; half <= searched.halves(); ++half) {
      const auto& found = searched.after(half);
      if (!found) continue;
      ASSERT_LE(std::abs(found->bias_scale_covariance), found->bias_sigma_dps * found->scale_sigma) << walls;
    }
  }
}

/// Else it would see that nothing moves.
TEST(GyroSearch, TakesNothingForTheWallsThatPixelsShowByThemselves) {
  Room room = turning_room(to_judge_s);
  room.contrast_k = 0.3;
  auto all = seen_in(room);
  std::mt19937 random(3);
  std::normal_distribution<float> off_k(0.0F, 1.0F);
  std::array<float, frame_pixels> errors_k{};
  for (float& one : errors_k) one = off_k(random);
  for (Seen& seen : all)
    for (std::size_t i = 0; i < frame_pixels; ++i) seen.frame.frame.temp_c[i] += errors_k[i];
  Searched searched;
  searched.look_at(all, room.duration_s);
  expect_right(searched.last(), room);
}

TEST(GyroSearch, NamesNothingBeforeABlankWall) {
  Room room = turning_room(30.0);
  room.contrast_k = 0.0;
  Searched searched;
  searched.turn_in(room);
  EXPECT_FALSE(searched.last());
}

TEST(GyroSearch, StandsByWhatItNamedUntilTwoSearchesNameTheSameOtherGyro) {
  Room room = turning_room(to_judge_s);
  Searched searched;
  searched.turn_in(room);
  const std::size_t before = searched.halves();
  Room other = turning_room(20.0);
  other.walls = 8;
  other.bias_dps = 16.0;
  searched.turn_in(other);
  expect_right(searched.after(before + 70), room);
  expect_right(searched.last(), other);
}

TEST(GyroSearch, ForgetsAll) {
  Searched searched;
  searched.turn_in(turning_room(to_judge_s));
  ASSERT_TRUE(searched.last());
  EXPECT_GT(searched.rows().margin, 0.0);
  searched.clear();
  EXPECT_FALSE(searched.last());
  EXPECT_EQ(searched.rows(), FoundRows());
}

}  // namespace
}  // namespace thermorig::odometer
