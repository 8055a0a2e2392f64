// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "../support/same_row.h"
#include "causal_run.h"
#include "thermorig/estimators/live/live_estimates.h"
#include "thermorig/pipeline/replay.h"

namespace thermorig::live {
namespace {

std::vector<EstimateRow> replayed(const RawRecording& raw, const std::optional<model::Model>& model) {
  pipeline::CausalReplay replay(raw);
  LiveEstimates estimator(paper_bank(model));
  std::vector<EstimateRow> rows;
  while (const auto moment = replay.next())
    for (const Measurement& measurement : moment->measurements)
      rows.push_back(estimator.add(measurement, moment->time));
  return rows;
}

TEST(AReplay, GivesTheRowsOfTheLiveRunBitForBit) {
  const pipeline::VirtualSweep sweep = two_legs();
  const auto measurements = measurements_of(sweep);
  const model::Model model = model_for(acquisition_of(measurements), {.frames = 3, .reduction = 2});
  const auto rows = rows_of(measurements, model);
  EXPECT_GE(rows.size() + 1, sweep.frames.size());
  EXPECT_TRUE(same_rows(replayed(recording_of(sweep), model), rows));
}

TEST(AReplay, TellsTheLastFramesAtTheEndOfTheRecording) {
  pipeline::VirtualSweep sweep = two_legs();
  const HostTime silent = sweep.chunks.back().arrived - std::chrono::milliseconds(300);
  std::erase_if(sweep.chunks, [&](const Chunk& chunk) {
    return chunk.device == Device::servo && chunk.arrived >= silent;  // the last frames wait for it
  });
  const RawRecording raw = recording_of(sweep);
  const auto rows = replayed(raw, std::nullopt);
  ASSERT_FALSE(rows.empty());
  EXPECT_EQ(rows.back().arrival, raw.end_time);
  EXPECT_TRUE(same_rows(rows, rows_of(measurements_of(sweep), std::nullopt)));
}

TEST(AReplay, WalksWhatCameAndWhatWasSentInOrderOfTime) {
  const RawRecording raw = recording_of(two_legs());
  Replay replay(raw);
  HostTime last{};
  PerDevice<std::size_t> bytes{};
  std::size_t sent = 0;
  while (const auto step = replay.next()) {
    EXPECT_LE(last, step->time);
    last = step->time;
    (step->from ? bytes[*step->from] : sent) += step->bytes.size();
  }
  for (const Device device : all_devices) EXPECT_EQ(bytes[device], raw.received[device].bytes.size());
  EXPECT_GT(sent, raw.sent[Device::servo].bytes.size() * 9 / 10);
}

TEST(AReplay, SaysToWhichDeviceBytesWent) {
  RawRecording raw;
  const std::vector<std::uint8_t> byte{1};
  raw.sent[Device::servo].append(byte, host_time_ns(10));
  raw.sent[Device::gyro].append(byte, host_time_ns(20));
  raw.sent[Device::servo].append(byte, host_time_ns(30));
  raw.sent[Device::camera].append(byte, host_time_ns(30));
  raw.sent[Device::gyro].append(byte, host_time_ns(40));
  raw.received[Device::camera].append(byte, host_time_ns(30));
  Replay replay(raw);
  std::vector<std::optional<Device>> to;
  while (const auto step = replay.next()) to.push_back(step->to);
  EXPECT_EQ(to, (std::vector<std::optional<Device>>{Device::servo, Device::gyro, Device::camera,
                                                    Device::servo, std::nullopt}));
}

TEST(AReplay, OfNothingEndsAtOnce) {
  const RawRecording raw;
  pipeline::CausalReplay replay(raw);
  EXPECT_TRUE(replay.next()->measurements.empty());
  EXPECT_FALSE(replay.next());
}

}  // namespace
}  // namespace thermorig::live
