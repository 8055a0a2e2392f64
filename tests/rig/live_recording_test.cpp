// SPDX-License-Identifier: MIT
// What a recording tells its observer, and what it can do without.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "simulated_bus.h"
#include "thermorig/pipeline/replay.h"
#include "thermorig/rig/recording/recording.h"

namespace thermorig::rig::test {
namespace {

using ::testing::HasSubstr;

/// What an observer was told, as far as it can be compared bit for bit.
struct Told {
  std::uint32_t index = 0;
  HostTime time{}, begin{}, end{}, arrived{};
  std::uint32_t label_bits = 0, gyro_bits = 0, reasons = 0, run = 0, pixel_bits = 0;
  std::uint16_t leg = 0;
  bool operator==(const Told&) const = default;
};

Told told(const Measurement& measurement, HostTime arrived) {
  const LabelledSample& sample = measurement.sample;
  return {sample.frame_index,
          sample.time,
          sample.exposure_begin,
          sample.exposure_end,
          arrived,
          std::bit_cast<std::uint32_t>(sample.rate_commanded_dps),
          std::bit_cast<std::uint32_t>(sample.rate_gyro_dps),
          sample.reason_bits,
          sample.run,
          std::bit_cast<std::uint32_t>(measurement.frame.frame.temp_c[100]),
          sample.leg};
}

/// A run in virtual time whose observer writes down what it is told, and answers with a row of it.
struct WatchedRun {
  VirtualOptions options;
  std::vector<Told> rows;
  std::vector<RecordingEvent> events;

  WatchedRun(const TemporaryFolder& folder, const RigProfile& profile) {
    options.recording = recording_options(folder, profile, short_plan());
    options.recording.estimators = {{.name = "gyro", .values = {}}};
    options.recording.observe = [this](const Measurement& measurement, HostTime arrived) {
      rows.push_back(told(measurement, arrived));
      const LabelledSample& sample = measurement.sample;
      return std::optional(EstimateRow{.frame_index = sample.frame_index,
                                       .time = sample.time,
                                       .exposure_begin = sample.exposure_begin,
                                       .exposure_end = sample.exposure_end,
                                       .arrival = arrived,
                                       .rate_commanded_dps = sample.rate_commanded_dps});
    };
    options.progress = [this](const RecordingProgress& progress) {
      events.insert(events.end(), progress.events.begin(), progress.events.end());
    };
  }

  std::ptrdiff_t count(EventKind kind) const {
    return std::count_if(events.begin(), events.end(),
                         [&](const RecordingEvent& event) { return event.kind == kind; });
  }
};

std::vector<Told> replayed(const RawRecording& raw) {
  std::vector<Told> rows;
  pipeline::CausalReplay replay(raw);
  while (const auto moment = replay.next())
    for (const Measurement& measurement : moment->measurements)
      rows.push_back(told(measurement, moment->time));
  return rows;
}

TEST(LiveRecording, TellsEachFrameOnceInOrderAndAReplayTellsTheSameBitForBit) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(3, "kitchen"));
  WatchedRun run(folder, simulation::default_profile());
  const RecordingResult result = record_virtual(bus, run.options);
  ASSERT_EQ(result.exit, ExitCode::ok) << result.message;
  const session::Session session = session::read_session(result.session);
  ASSERT_EQ(run.rows.size(), session.frames.size());
  for (std::size_t i = 0; i < run.rows.size(); ++i) EXPECT_EQ(run.rows[i].index, i);
  EXPECT_TRUE(run.rows == replayed(session.raw));
}

TEST(LiveRecording, AnObserverChangesNothingOfWhatIsRecorded) {
  const TemporaryFolder folder;
  std::vector<RawRecording> raws;
  for (const bool watched : {false, true}) {
    SimulatedBus bus(simulation::default_rig(3, "kitchen"));
    WatchedRun run(folder, simulation::default_profile());
    if (!watched) run.options.recording.observe = {};
    raws.push_back(session::read_raw(record_virtual(bus, run.options).session));
  }
  for (const Device device : all_devices) {
    EXPECT_TRUE(raws[0].received[device].bytes == raws[1].received[device].bytes) << name_of(device);
    EXPECT_TRUE(raws[0].received[device].time_ns == raws[1].received[device].time_ns) << name_of(device);
  }
  EXPECT_TRUE(raws[0].sent[Device::servo].bytes == raws[1].sent[Device::servo].bytes);
}

TEST(LiveRecording, KeepsNothingWhereNothingIsToBeKept) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(3, "kitchen"));
  WatchedRun run(folder, simulation::default_profile());
  run.options.recording.keep = false;
  const RecordingResult result = record_virtual(bus, run.options);
  EXPECT_EQ(result.exit, ExitCode::ok) << result.message;
  EXPECT_TRUE(result.session.empty());
  EXPECT_EQ(result.acquisition, 0);
  EXPECT_GT(run.rows.size(), 50U);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(LiveRecording, WritesMarksAndStopsOnOrderAndSaysWhoAsked) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(3, "kitchen"));
  WatchedRun run(folder, simulation::default_profile());
  run.options.orders = [&, asked = 0]() mutable -> std::vector<Order> {
    ++asked;
    if (asked == 500) return {{OrderKind::mark, "a door was opened"}};
    if (asked == 1000) return {{OrderKind::stop, "the page"}};
    return {};
  };
  const RecordingResult result = record_virtual(bus, run.options);
  EXPECT_EQ(result.exit, ExitCode::interrupted);
  EXPECT_THAT(result.message, HasSubstr("the page"));
  EXPECT_EQ(run.count(EventKind::mark), 1);
  const RawRecording raw = session::read_raw(result.session);
  const auto mark = std::find_if(raw.events.begin(), raw.events.end(),
                                 [](const RecordingEvent& event) { return event.kind == EventKind::mark; });
  ASSERT_NE(mark, raw.events.end());
  EXPECT_EQ(mark->message, "a door was opened");
}

TEST(LiveRecording, WaitsForTheOrderToStart) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(3, "kitchen"));
  WatchedRun run(folder, simulation::default_profile());
  run.options.recording.wait_for_start = true;
  run.options.orders = [&, asked = 0]() mutable -> std::vector<Order> {
    return ++asked == 2000 ? std::vector<Order>{{OrderKind::start, ""}} : std::vector<Order>{};
  };
  std::optional<double> began_s;
  run.options.progress = [&](const RecordingProgress& progress) {
    if (progress.sweep.phase != SweepPhase::waiting && !began_s) began_s = progress.elapsed_s;
  };
  EXPECT_EQ(record_virtual(bus, run.options).exit, ExitCode::ok);
  EXPECT_GT(began_s.value_or(0.0), 7.0);  // 2000 steps of 3 to 5 ms
}

TEST(LiveRecording, KeepsWhatCameBeforeADeviceWentWhileItWaitedForItsStart) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(3, "kitchen"));
  bus.is_cut = [](Device device, HostTime now) {
    return device == Device::camera && to_s(now - HostTime{}) > 4.0;
  };
  WatchedRun run(folder, simulation::default_profile());
  run.options.recording.wait_for_start = true;
  const RecordingResult result = record_virtual(bus, run.options);
  EXPECT_EQ(result.exit, ExitCode::device_lost) << result.message;
  EXPECT_GT(session::read_session(result.session).frames.size(), 10U);
}

TEST(LiveRecording, GoesOnWithoutAGyroThatIsNotNeeded) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(3, "kitchen"));
  bus.is_cut = [](Device device, HostTime) { return device == Device::gyro; };
  WatchedRun run(folder, simulation::default_profile());
  run.options.recording.needed[Device::gyro] = false;
  const RecordingResult result = record_virtual(bus, run.options);
  EXPECT_EQ(result.exit, ExitCode::finished_lossy);
  EXPECT_THAT(result.message, HasSubstr("without the gyro"));
  EXPECT_EQ(run.count(EventKind::missing), 1);
  EXPECT_EQ(run.count(EventKind::finished), 1);
  ASSERT_GT(run.rows.size(), 50U);
  for (const Told& row : run.rows) EXPECT_TRUE(std::isnan(std::bit_cast<float>(row.gyro_bits)));
  const session::Session session = session::read_session(result.session);
  EXPECT_EQ(session.raw.estimates.size(), session.frames.size());
}

TEST(LiveRecording, GoesOnByTimeWithoutACameraAndTellsTheGyroAgainstTheServo) {
  for (const bool from_the_start : {true, false}) {
    const TemporaryFolder folder;
    SimulatedBus bus(simulation::default_rig(3, "kitchen"));
    bus.is_cut = [&](Device device, HostTime now) {
      return device == Device::camera && (from_the_start || to_s(now - HostTime{}) > 4.0);
    };
    WatchedRun run(folder, simulation::default_profile());
    run.options.recording.needed[Device::camera] = false;
    const RecordingResult result = record_virtual(bus, run.options);
    EXPECT_EQ(result.exit, ExitCode::finished_lossy) << result.message;
    EXPECT_THAT(result.message, HasSubstr("without the camera"));
    EXPECT_EQ(run.count(EventKind::missing), 1);
    EXPECT_EQ(run.count(EventKind::finished), 1);
    std::ptrdiff_t told_of_gyro = 0;
    for (std::size_t i = 0; i < run.rows.size(); ++i) {
      EXPECT_EQ(run.rows[i].index, i);
      const float gyro_dps = std::bit_cast<float>(run.rows[i].gyro_bits);
      const bool in_run = run.rows[i].run != 0;
      if (in_run && std::isnan(std::bit_cast<float>(run.rows[i].pixel_bits)) && !std::isnan(gyro_dps))
        ++told_of_gyro;
    }
    EXPECT_GT(told_of_gyro, 10) << from_the_start;
    EXPECT_TRUE(run.rows == replayed(session::read_raw(result.session))) << from_the_start;
  }
}

TEST(LiveRecording, RowsAndFramesOfOneIndexAreApartInTimeWhereTheCameraCameBack) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(3, "kitchen"));
  bus.is_cut = [](Device device, HostTime now) {
    const double now_s = to_s(now - HostTime{});
    return device == Device::camera && now_s > 4.0 && now_s < 10.0;
  };
  WatchedRun run(folder, simulation::default_profile());
  run.options.recording.needed[Device::camera] = false;
  const RecordingResult result = record_virtual(bus, run.options);
  ASSERT_EQ(result.exit, ExitCode::finished_lossy) << result.message;
  const session::Session session = session::read_session(result.session);
  const std::vector<EstimateRow>& rows = session.raw.estimates;
  std::size_t of_frames = 0, of_others = 0;
  for (std::size_t i = 0; i < rows.size() && i < session.samples.size(); ++i) {
    ASSERT_EQ(rows[i].frame_index, i);
    const bool is_its_own = std::isfinite(std::bit_cast<float>(run.rows[i].pixel_bits));
    const double apart_s = std::abs(to_s(rows[i].time - session.samples[i].time));
    EXPECT_EQ(apart_s <= session.frame_period_s / 2.0, is_its_own) << i;
    ++(is_its_own ? of_frames : of_others);
  }
  EXPECT_GT(of_frames, 10U);
  EXPECT_GT(of_others, 10U);
}

TEST(LiveRecording, EndsWhenNeitherCameraNorGyroIsThere) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(3, "kitchen"));
  bus.is_cut = [](Device device, HostTime now) {
    return device != Device::servo && to_s(now - HostTime{}) > 4.0;
  };
  WatchedRun run(folder, simulation::default_profile());
  run.options.recording.needed = {{false, false, true}};
  EXPECT_EQ(record_virtual(bus, run.options).exit, ExitCode::device_lost);
}

TEST(LiveRecording, RepeatsAPlanUntilItIsStopped) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(3, "kitchen"));
  WatchedRun run(folder, simulation::default_profile());
  run.options.recording.plan.repeat = true;
  run.options.stop_requested = [&, asked = 0]() mutable { return ++asked > 8000; };
  const RecordingResult result = record_virtual(bus, run.options);
  EXPECT_EQ(result.exit, ExitCode::interrupted);
  EXPECT_GT(run.count(EventKind::leg_start), 6);  // the plan has four
}

}  // namespace
}  // namespace thermorig::rig::test
