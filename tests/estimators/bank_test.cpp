// SPDX-License-Identifier: MIT
// What holds for every estimator of the table.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../network/allocations.h"
#include "../pipeline/scripted_bytes.h"
#include "hand_made.h"
#include "support/at_s.h"
#include "support/chunking.h"

namespace thermorig::estimators {
namespace {

using Estimates = std::vector<std::vector<RateEstimate>>;

Bank bank_of_all() {
  return Bank({}, untrained_model({.frames = 2, .reduction = 3}), {});
}

Estimates estimates_of_all(const std::vector<Measurement>& measurements) {
  Bank bank = bank_of_all();
  return all_estimates_of(bank, measurements);
}

void expect_same(const Estimates& a, const Estimates& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_TRUE(are_same(a[i], b[i])) << "measurement " << i;
}

/// A rest, a motion, a rest; some samples lost.
std::vector<Measurement> short_run() {
  HandMadeRig rig;
  rig.is_told_to_move = [](double time_s) { return time_s >= 3.0 && time_s < 6.0; };
  rig.gyro_dps = [](double time_s) {
    return static_cast<float>(1.0 + (time_s >= 3.0 && time_s < 6.0 ? 100.0 * std::sin(time_s) : 0.0));
  };
  rig.has_gyro = [](double time_s) { return time_s < 4.0 || time_s > 4.3; };
  return measurements_of(rig);
}

TEST(EveryEstimator, SaysOfAFrameNothingThatDependsOnWhatComesLater) {
  const auto run = short_run();
  const Estimates all = estimates_of_all(run);
  for (const std::size_t count : {std::size_t{1}, run.size() / 3, run.size() / 2, run.size() - 1}) {
    const std::vector<Measurement> beginning(run.begin(), run.begin() + static_cast<std::ptrdiff_t>(count));
    expect_same(estimates_of_all(beginning), {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count)});
  }
}

TEST(EveryEstimator, AsksForNoMemoryMeasurementByMeasurement) {
  const auto run = short_run();
  Bank bank = bank_of_all();
  bank.add(run.front());
  const std::size_t before = allocations();
  for (std::size_t i = 1; i < run.size(); ++i) bank.add(run[i]);
  EXPECT_EQ(allocations(), before);
}

/// Each chunk in pieces that arrive at its time.
std::vector<Chunk> cut(const std::vector<Chunk>& chunks, std::size_t bytes) {
  std::vector<Chunk> pieces;
  for (const Chunk& chunk : chunks)
    for (const test::ByteSpan piece : test::even_chunks(chunk.bytes, bytes))
      pieces.push_back({chunk.device, chunk.arrived, {piece.begin(), piece.end()}});
  return pieces;
}

TEST(EveryEstimator, SaysTheSameHoweverTheBytesWereCut) {
  const pipeline::ScriptedRecording recording;
  const auto chunks = chunks_across_messages(recording, 1, 300);
  const pipeline::Fits fits = pipeline::first_pass(recording.profile, chunks);  // times depend on the reads
  const auto estimates_of_pieces = [&](std::size_t bytes) {
    return estimates_of_all(pipeline::run(recording.profile, cut(chunks, bytes), fits).measurements);
  };
  const Estimates whole = estimates_of_pieces(300);
  ASSERT_GT(whole.size(), 30U);
  EXPECT_EQ(whole[20][0].state, EstimateState::good);
  EXPECT_EQ(whole[20][4].state, EstimateState::good);
  for (const std::size_t bytes : {1, 2, 7, 64, 150}) expect_same(estimates_of_pieces(bytes), whole);
}

TEST(EveryEstimatorOfTheGyro, GoesOnWhereFramesStandInForACameraThatIsMissing) {
  const pipeline::ScriptedRecording recording;
  pipeline::Pipeline pipeline(recording.profile);
  pipeline.stand_in_for_camera(HostTime{});
  Bank bank = bank_of_all();
  Estimates estimates;
  const auto take = [&](const std::vector<Measurement>& some) {
    for (const Measurement& measurement : some) {
      EXPECT_TRUE(measurement.frame.stands_in);
      const auto all = bank.add(measurement);
      estimates.emplace_back(all.begin(), all.end());
    }
  };
  for (const Chunk& chunk : chunks_within_messages(recording, 1000))
    if (chunk.device != Device::camera) take(pipeline.feed(chunk.device, chunk.bytes, chunk.arrived));
  take(pipeline.finish());
  ASSERT_GT(estimates.size(), 20U);
  for (std::size_t frame = 1; frame < estimates.size(); ++frame) {  // of a window of two
    const auto& all = estimates[frame];
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Inputs& inputs = bank.entries()[i]->inputs;
      if (inputs.image) {
        EXPECT_EQ(all[i].reason, EstimateReason::no_image);
      } else if (!inputs.rest) {
        EXPECT_EQ(all[i].state, EstimateState::good);
      }
    }
  }
}

/// The bank after a run and something that no rig does; then the run again, `later_s` later.
Estimates estimates_around(const std::vector<Measurement>& strange, double later_s) {
  Bank bank = bank_of_all();
  Estimates estimates = all_estimates_of(bank, short_run());
  const auto add = [&](const Estimates& more) {
    estimates.insert(estimates.end(), more.begin(), more.end());
  };
  add(all_estimates_of(bank, strange));
  auto again = short_run();
  for (Measurement& measurement : again) {
    const HostDuration later = from_s(later_s);
    measurement.frame.exposure_begin += later;
    measurement.frame.exposure_end += later;
    for (TimedGyro& sample : measurement.gyro) sample.stamp.time += later;
    for (TimedServo& state : measurement.servo) state.stamp.time += later;
  }
  add(all_estimates_of(bank, again));
  return estimates;
}

/// Nothing that is told as known is infinite, or less than nothing.
void expect_sound(const Estimates& estimates) {
  for (const auto& all : estimates) {
    for (const RateEstimate& one : all) {
      EXPECT_FALSE(std::isinf(one.rate_dps) || std::isinf(one.angle_deg));
      EXPECT_FALSE(one.rate_sigma_dps < 0.0F || one.angle_sigma_deg < 0.0F);
      EXPECT_FALSE(std::isinf(one.rate_sigma_dps) || std::isinf(one.angle_sigma_deg));
      if (one.state != EstimateState::absent) {
        EXPECT_TRUE(std::isfinite(one.rate_dps));
      }
    }
  }
}

/// All say of the last frame what they say of it without what came before.
void expect_recovered(const Estimates& estimates) {
  const Estimates alone = estimates_of_all(short_run());
  for (std::size_t i = 0; i < alone.back().size(); ++i) {
    EXPECT_EQ(estimates.back()[i].state, alone.back()[i].state) << i;
    if (alone.back()[i].state == EstimateState::absent) continue;
    EXPECT_NEAR(estimates.back()[i].rate_dps, alone.back()[i].rate_dps, 0.1F) << i;
  }
}

TEST(EveryEstimator, OutlivesRatesThatAreNone) {
  for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity(), 1e38F}) {
    auto strange = measurements_of({.duration_s = 1.0});
    for (Measurement& measurement : strange) {
      measurement.sample.rate_gyro_dps = wrong;
      for (TimedGyro& sample : measurement.gyro) sample.rate_dps = wrong;
    }
    const Estimates estimates = estimates_around(strange, 20.0);
    expect_sound(estimates);
    expect_recovered(estimates);
    const auto& during = estimates[short_run().size() + 3];
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(during[i].reason, EstimateReason::no_gyro);
  }
}

TEST(EveryEstimator, OutlivesAClockThatBeginsAnew) {
  const Estimates estimates = estimates_around({}, -5000.0);
  expect_sound(estimates);
  expect_recovered(estimates);
}

TEST(EveryEstimator, OutlivesAGapOfAnHour) {
  const Estimates estimates = estimates_around({}, 3600.0);
  expect_sound(estimates);
  expect_recovered(estimates);
}

TEST(EveryEstimatorOfTheGyro, SaysThatItsAngleIsLostOverAGapOfAnHour) {
  const Estimates estimates = estimates_around({}, 3600.0);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_GT(estimates.back()[i].angle_sigma_deg, 100'000.0F);
}

}  // namespace
}  // namespace thermorig::estimators
