// SPDX-License-Identifier: MIT
// Each frame comes with all that was measured since the frame before.
#include <gtest/gtest.h>

#include <algorithm>

#include "pipeline/measurements.h"
#include "scripted_bytes.h"

namespace thermorig::pipeline {
namespace {

/// Every sample of `all` up to the last frame's end, once, in order, no later than its frame's end.
template <typename Sample>
void expect_each_once(const std::vector<Measurement>& measurements, std::vector<Sample> Measurement::*part,
                      const std::vector<Sample>& all) {
  std::size_t next = 0;
  for (const Measurement& measurement : measurements)
    for (const Sample& sample : measurement.*part) {
      ASSERT_LT(next, all.size());
      EXPECT_EQ(sample.span.begin, all[next].span.begin);
      EXPECT_LE(sample.stamp.time, measurement.frame.exposure_end);
      ++next;
    }
  for (; next < all.size(); ++next)
    EXPECT_GT(all[next].stamp.time, measurements.back().frame.exposure_end) << next;
}

TEST(AMeasurement, HoldsEverySampleSinceTheOneBeforeHoweverTheBytesCame) {
  const ScriptedRecording recording;
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Result result = run(recording.profile, chunks_across_messages(recording, seed, 700));
    ASSERT_EQ(result.measurements.size(), result.streams.frames.size());
    expect_each_once(result.measurements, &Measurement::gyro, result.streams.gyro);
    expect_each_once(result.measurements, &Measurement::servo, result.streams.servo);
  }
}

TEST(AMeasurement, IsOfTheFrameThatItsLabelIsOf) {
  const ScriptedRecording recording;
  const Result result = run(recording.profile, chunks_across_messages(recording, 1, 700));
  for (std::size_t i = 0; i < result.measurements.size(); ++i) {
    const auto& [frame, sample, gyro, servo] = result.measurements[i];
    EXPECT_EQ(sample.frame_index, i);
    EXPECT_EQ(frame.span.begin, result.streams.frames[i].span.begin);
    EXPECT_EQ(frame.frame.temp_c, result.streams.frames[i].frame.temp_c);
    EXPECT_EQ(sample.exposure_begin, frame.exposure_begin);
    EXPECT_EQ(sample.exposure_end, frame.exposure_end);
  }
}

TEST(AMeasurement, AfterAnHourWithoutAFrameHasTheNewestSamplesAndSaysThatSomeAreGone) {
  Measurements waiting;
  constexpr int sent = (1 << 20) + 5;
  for (int i = 1; i <= sent; ++i) {
    TimedGyro sample;
    sample.stamp.time = HostTime(std::chrono::milliseconds(i));
    waiting.add(sample);
  }
  TimedFrame frame;
  frame.exposure_end = HostTime(std::chrono::hours(1));
  waiting.add(frame);
  const std::vector<Measurement> measurements = waiting.with({LabelledSample()});
  ASSERT_EQ(measurements.size(), 1U);
  const std::vector<TimedGyro>& gyro = measurements.front().gyro;
  ASSERT_EQ(gyro.size(), std::size_t{1} << 20);
  EXPECT_EQ(gyro.front().stamp.time, HostTime(std::chrono::milliseconds(6)));
  EXPECT_TRUE(gyro.front().lost_before);
  EXPECT_EQ(std::count_if(gyro.begin(), gyro.end(), [](const TimedGyro& one) { return one.lost_before; }), 1);
}

}  // namespace
}  // namespace thermorig::pipeline
