// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <chrono>
#include <limits>

#include "../session/synthetic_session.h"
#include "text_sink.h"
#include "thermorig/learning/dataset/dataset.h"
#include "thermorig/learning/interchange/formats.h"

namespace thermorig::interchange {
namespace {

using session::Session;
using session::SyntheticSession;

TEST(Interchange, HoldsNoMoreThanAPieceOfAFileInMemory) {
  const Session session = SyntheticSession(1500, 1).take();
  const network::Acquisition acquisition = dataset::acquisition_of(session, "garden_acq-01");
  TextSink rows, windows, mcap, csv;
  write_rows_npz(session, rows);
  write_windows_npz(session, acquisition, {.frames = 2}, windows);
  write_mcap(session, mcap);
  write_csv(table_of(session, "camera"), csv);
  EXPECT_GT(rows.text.size(), 4'000'000U);
  for (const TextSink* sink : {&rows, &windows, &mcap, &csv}) EXPECT_LT(sink->most_at_once, 1'200'000U);
}

TEST(Interchange, MakesFilesOfASessionWithoutFramesToo) {
  const Session session = SyntheticSession(0, 1).take();
  TextSink npz, mcap, csv;
  write_rows_npz(session, npz);
  write_mcap(session, mcap);
  for (const std::string& name : table_names()) write_csv(table_of(session, name), csv);
  EXPECT_EQ(npz.text.substr(0, 4), "PK\x03\x04");
  EXPECT_EQ(mcap.text.substr(0, 5), "\x89MCAP");
  for (const char* column : {"rate_commanded [deg/s]", "rate_commanded_uncertainty [deg/s]",
                             "rate_corrected [deg/s]", "rate_corrected_uncertainty [deg/s]"})
    EXPECT_NE(csv.text.find(column), std::string::npos) << column;
  for (const Trajectory& trajectory : trajectories_of(session)) EXPECT_TRUE(trajectory.angles.empty());
}

TEST(Shaft, IsNotKnownWhereTelemetryIsMissing) {
  Session session = SyntheticSession(60, 1).take();
  for (LabelledSample& sample : session.samples) sample.reason_bits = 0;
  const auto times = [&] {
    std::vector<HostTime> known;
    const std::vector<Trajectory> trajectories = trajectories_of(session);
    for (const AngleAt& at : trajectories.front().angles) known.push_back(at.time);
    return known;
  };
  const std::vector<HostTime> before = times();
  ASSERT_GT(before.size(), 40U);
  session.samples[30].reason_bits = bit(Reason::servo_lost);
  EXPECT_EQ(times().size(), before.size() - 1);
  for (const HostTime time : times()) EXPECT_NE(time, session.frames[30].exposure_end);
}

/// A file holds times of up to 31 years, in any order.
TEST(Shaft, IsFoundInAFileOfAnyTimes) {
  Session session = SyntheticSession(200, 1).take();
  for (std::size_t i = session.servo.size() / 2; i < session.servo.size(); ++i)
    session.servo[i].stamp.time += std::chrono::hours(24 * 365 * (i % 2 == 0 ? 3 : 30));
  for (std::size_t i = 100; i < 200; ++i) session.frames[i].exposure_end += std::chrono::hours(24 * 365 * 30);
  EXPECT_LE(trajectories_of(session).front().angles.size(), 200U);
}

TEST(UnixTimes, AreThoseFrom1970To2262) {
  const auto has_times_at = [](std::int64_t start_ns) {
    RawRecording raw;
    raw.header.time_reference = host_time_ns(1'000'000'000);
    raw.end_time = host_time_ns(61'000'000'000);
    raw.header.realtime_offset_ns = start_ns - 1'000'000'000;
    return has_unix_times(raw);
  };
  constexpr std::int64_t latest = std::numeric_limits<std::int64_t>::max();
  EXPECT_TRUE(has_times_at(0));
  EXPECT_TRUE(has_times_at(1'700'000'000'000'000'000));
  EXPECT_FALSE(has_times_at(-1)) << "a clock that says 1969";
  EXPECT_FALSE(has_times_at(latest - 30'000'000'000)) << "it ends behind 2262";
}

TEST(Tum, TurnsAboutTheServosAxis) {
  RecordingHeader header;
  header.realtime_offset_ns = 1'700'000'000'000'000'000;
  TextSink sink;
  write_tum(header, {"shaft", {{host_time_ns(5), 0.0}, {host_time_ns(1'000'000'000), 180.0}}}, sink);
  EXPECT_EQ(sink.text,
            "# timestamp x y z q_x q_y q_z q_w\n"
            "1700000000.000000005 0 0 0 0 0 0 1\n"
            "1700000001.000000000 0 0 0 0 0 1 6.123233995736766e-17\n");
}

}  // namespace
}  // namespace thermorig::interchange
