// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../session/synthetic_session.h"
#include "thermorig/dataset/dataset.h"

namespace thermorig::dataset {
namespace {

using session::Session;
using windows::Acquisition;

Session made_session() {
  return session::SyntheticSession(130, 5).take();
}

Acquisition acquired(const Session& session) {
  return acquisition_of(session, "garden_acq-02");
}

TEST(Acquisition, HasARowAFrame) {
  const Session session = made_session();
  const Acquisition acquisition = acquired(session);
  ASSERT_EQ(acquisition.frames(), 130U);
  ASSERT_EQ(acquisition.temp_c.size(), 130U * frame_pixels);
  EXPECT_EQ(acquisition.temp_c[100 * frame_pixels + 17], session.frames[100].frame.temp_c[17]);
  EXPECT_EQ(acquisition.gyro_dps[100], session.samples[100].rate_gyro_dps);
  EXPECT_EQ(acquisition.time[100], session.samples[100].time);
  EXPECT_EQ(acquisition.run[100], 2U);
  EXPECT_EQ(acquisition.environment, "garden");
  EXPECT_EQ(acquisition.number, 2);
  EXPECT_TRUE(acquisition.simulated);
  EXPECT_EQ(acquisition.licence, "CC-BY-4.0");
}

TEST(Acquisition, SaysThatNoLicenceOfItsDataIsStated) {
  Session session = made_session();
  session.raw.header.licence.clear();
  EXPECT_EQ(acquired(session).licence, "not stated");
}

TEST(Acquisition, TakesTheCommandedSpeedForItsLabel) {
  const Session session = made_session();
  EXPECT_EQ(acquired(session).label_dps[100], session.samples[100].rate_commanded_dps);
  EXPECT_NE(acquired(session).label_dps[100], session.samples[100].rate_label_dps);
}

TEST(Acquisition, HasTheStaticBiasThatTheSessionFoundBeforeItsFirstLeg) {
  Session session = made_session();
  session.sync.gyro.bias_before_dps = 0.39;
  EXPECT_EQ(acquired(session).rest_bias_dps, 0.39);
  session.sync.gyro.bias_before_dps.reset();
  EXPECT_TRUE(std::isnan(acquired(session).rest_bias_dps));
  session.sync.gyro.bias_before_dps = std::numeric_limits<double>::infinity();  // a file may say anything
  EXPECT_TRUE(std::isnan(acquired(session).rest_bias_dps));
}

TEST(Acquisition, KnowsTheSpeedOfTheLegAndNoneOutsideLegs) {
  Session session = made_session();
  session.samples[70].leg = 0;
  session.samples[71].leg = 999;  // of which the session has no record
  const Acquisition acquisition = acquired(session);
  EXPECT_FLOAT_EQ(acquisition.leg_rate_dps[10], 7.5F);
  EXPECT_FLOAT_EQ(acquisition.leg_rate_dps[100], 15.0F);
  EXPECT_EQ(acquisition.leg_rate_dps[70], 0.0F);
  EXPECT_EQ(acquisition.leg_rate_dps[71], 0.0F);
}

TEST(Acquisition, TakesNoFrameForValidThatIsNot) {
  Session session = made_session();
  session.samples[100].valid = false;  // though the file gives it a run
  session.samples[101].rate_gyro_dps = std::numeric_limits<float>::quiet_NaN();
  session.samples[102].rate_commanded_dps = 1e30F;
  session.frames[103].frame.temp_c[5] = std::numeric_limits<float>::quiet_NaN();
  const Acquisition acquisition = acquired(session);
  for (const std::size_t frame : {100U, 101U, 102U, 103U}) EXPECT_EQ(acquisition.run[frame], 0U) << frame;
  EXPECT_EQ(acquisition.run[104], 2U);
}

TEST(Acquisition, OfNothingIsEmpty) {
  const Acquisition acquisition = acquired(session::SyntheticSession(0, 1).take());
  EXPECT_EQ(acquisition.frames(), 0U);
  EXPECT_EQ(acquisition.hash.size(), 64U);
}

TEST(DataHash, DoesNotMindWhenAndWhereItWasRecorded) {
  Session session = made_session();
  const std::string hash = acquired(session).hash;
  EXPECT_EQ(hash.size(), 64U);
  session.raw.header.uuid = "another";
  session.raw.header.start_time_utc = "2027-01-01T00:00:00.000000Z";
  session.raw.header.host_name = "elsewhere";
  for (LabelledSample& sample : session.samples) sample.time += std::chrono::hours(5);
  EXPECT_EQ(acquired(session).hash, hash);
}

TEST(DataHash, DiffersWithWhateverANetworkOrAnEvaluationSees) {
  const Session session = made_session();
  const std::string hash = acquired(session).hash;
  const auto changed = [&](auto change) {
    Session other = session;
    change(other);
    return acquired(other).hash != hash;
  };
  EXPECT_TRUE(changed([](Session& s) { s.frames[3].frame.temp_c[9] += 0.01F; }));
  EXPECT_TRUE(changed([](Session& s) { s.samples[100].rate_commanded_dps += 0.001F; }));
  EXPECT_TRUE(changed([](Session& s) { s.samples[100].rate_gyro_dps += 0.001F; }));
  EXPECT_TRUE(changed([](Session& s) { s.samples[100].time += std::chrono::nanoseconds(1); }));
  EXPECT_TRUE(changed([](Session& s) { s.samples[100].valid = false; }));
  EXPECT_TRUE(changed([](Session& s) { s.raw.legs[0].rate_dps = 9.0; }));
}

TEST(DataHash, TakesEveryNotANumberForTheSame) {
  Session session = made_session();
  ASSERT_TRUE(std::isnan(session.samples[0].rate_gyro_dps));
  const std::string hash = acquired(session).hash;
  session.samples[0].rate_gyro_dps = -std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(acquired(session).hash, hash);
}

}  // namespace
}  // namespace thermorig::dataset
