// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../session/synthetic_session.h"
#include "thermorig/core/bad_pixels.h"
#include "thermorig/core/error.h"
#include "thermorig/estimators/table.h"
#include "thermorig/learning/dataset/dataset.h"

namespace thermorig::dataset {
namespace {

using network::Acquisition;
using session::Session;

Session made_session() {
  return session::SyntheticSession(130, 5).take();
}

Acquisition acquired(const Session& session) {
  Acquisition acquisition = acquisition_of(session, "garden_acq-02");
  add_estimates(acquisition, session);
  return acquisition;
}

std::vector<float> rates(const Acquisition& acquisition, const std::string& estimator) {
  for (const network::RateSeries& series : acquisition.rates)
    if (series.name == estimator) return series.rate_dps;
  return {};
}

TEST(Acquisition, HasARowAFrame) {
  const Session session = made_session();
  const Acquisition acquisition = acquired(session);
  ASSERT_EQ(acquisition.frames(), 130U);
  ASSERT_EQ(acquisition.temp_c.size(), 130U * frame_pixels);
  EXPECT_EQ(acquisition.temp_c[100 * frame_pixels + 17], session.frames[100].frame.temp_c[17]);
  ThermalFrame mended = session.frames[100].frame;
  mend(mended, pixel_places("3,17 12,5"));  // the session's bad pixels
  constexpr std::size_t bad = 3 * frame_columns + 17;
  EXPECT_EQ(acquisition.temp_c[100 * frame_pixels + bad], mended.temp_c[bad]);
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
  EXPECT_NE(acquired(session).label_dps[100], session.samples[100].rate_shaft_dps);
}

TEST(Acquisition, TakesTheLabelThatIsAskedForAndTheShaftBesideIt) {
  const Session session = made_session();
  const auto with = [&](Label label) { return acquisition_of(session, "garden_acq-02", label); };
  EXPECT_EQ(with(Label::corrected).label_dps[100], session.samples[100].rate_corrected_dps);
  EXPECT_EQ(with(Label::shaft).label_dps[100], session.samples[100].rate_shaft_dps);
  EXPECT_EQ(with(Label::shaft).label, Label::shaft);
  EXPECT_EQ(with(Label::commanded).shaft_dps[100], session.samples[100].rate_shaft_dps);
}

TEST(Acquisition, IsKnownByOneHashWhateverItsLabelAndByAnotherAsItIsLearnt) {
  Session session = made_session();
  const auto with = [&](Label label) { return acquisition_of(session, "garden_acq-02", label); };
  const Acquisition commanded = with(Label::commanded), corrected = with(Label::corrected);
  EXPECT_EQ(corrected.hash, commanded.hash);
  EXPECT_EQ(commanded.learnt_hash(), commanded.hash);
  EXPECT_NE(corrected.learnt_hash(), commanded.hash);
  EXPECT_NE(corrected.learnt_hash(), with(Label::shaft).learnt_hash());
  session.samples[100].rate_corrected_dps += 0.25F;
  EXPECT_EQ(with(Label::corrected).hash, commanded.hash);
  EXPECT_NE(with(Label::corrected).learnt_hash(), corrected.learnt_hash());
}

TEST(Acquisition, TakesNoFrameForValidWhoseLabelIsNoSpeed) {
  Session session = made_session();
  session.samples[100].rate_corrected_dps = std::numeric_limits<float>::quiet_NaN();
  const auto run = [&](Label label) { return acquisition_of(session, "garden_acq-02", label).run[100]; };
  EXPECT_EQ(run(Label::commanded), 2U);
  EXPECT_EQ(run(Label::corrected), 0U);
}

TEST(Acquisition, OfAFormatBeforeItsLabelIsToBeMadeAnew) {
  Session session = made_session();
  for (const auto& [version, lacking] : {std::pair{3U, 0}, std::pair{2U, 1}, std::pair{1U, 2}}) {
    session.label_version = version;
    int refused = 0;
    for (const Label label : {Label::commanded, Label::shaft, Label::corrected}) {
      try {
        require_label(session, label, "old.h5");
      } catch (const Error& error) {
        ++refused;
        EXPECT_EQ(error.code(), ExitCode::check_failed);
        EXPECT_EQ(error.what_happened(), "the session is of a format that had no " + column_of(label));
        EXPECT_NE(error.advice().find("thermorig reprocess old.h5"), std::string::npos);
      }
    }
    EXPECT_EQ(refused, lacking) << version;
  }
}

TEST(Acquisition, HoldsWhatEveryEstimatorSaysThatNeedsNoNetwork) {
  const Acquisition acquisition = acquired(made_session());
  const std::vector<std::string> names = estimators::names_for(std::nullopt);
  ASSERT_GE(acquisition.rates.size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(acquisition.rates[i].name, names[i]);
    EXPECT_EQ(acquisition.rates[i].frames, 1);
    EXPECT_EQ(acquisition.rates[i].rate_dps.size(), acquisition.frames());
  }
  EXPECT_TRUE(std::isnan(rates(acquisition, "gyro")[0]));  // as its mean is
  for (std::size_t i = 1; i < acquisition.frames(); ++i)
    EXPECT_EQ(rates(acquisition, "gyro")[i], acquisition.gyro_dps[i]);
}

TEST(Acquisition, HoldsWhatAnEstimatorFindsOfLongerWindowsAtOnceBehindAllOthers) {
  const Acquisition acquisition = acquired(made_session());
  std::size_t place = estimators::names_for(std::nullopt).size();
  for (const int frames : {2, 3}) {
    ASSERT_LT(place, acquisition.rates.size());
    EXPECT_EQ(acquisition.rates[place].name, "thermal-likelihood");
    EXPECT_EQ(acquisition.rates[place].frames, frames);
    EXPECT_EQ(acquisition.rates[place++].rate_dps.size(), acquisition.frames());
  }
  EXPECT_EQ(place, acquisition.rates.size());
}

TEST(Acquisition, HasBoundsOnlyWhereTheyWereAskedForAndNoneWithoutAPanorama) {
  EXPECT_TRUE(acquired(made_session()).bound_dps.empty());
  Acquisition acquisition = acquisition_of(made_session(), "garden_acq-02");
  add_estimates(acquisition, made_session(), 3);
  EXPECT_EQ(acquisition.bound_frames, 3);
  ASSERT_EQ(acquisition.bound_dps.size(), acquisition.frames());
  for (const float bound_dps : acquisition.bound_dps) EXPECT_TRUE(std::isnan(bound_dps));
}

TEST(Acquisition, ShowsItsEstimatorsTheSamplesUpToEachFrameAndNoneThatComesLater) {
  Session session = made_session();
  const std::vector<float> before = rates(acquired(session), "gyro-kalman");
  const HostTime end = session.frames[60].exposure_end;
  for (TimedGyro& sample : session.gyro)
    if (sample.stamp.time > end) sample.rate_dps += 100.0F;
  const std::vector<float> after = rates(acquired(session), "gyro-kalman");
  ASSERT_TRUE(std::isfinite(before[60]) && std::isfinite(before[65]));
  EXPECT_EQ(std::vector(before.begin() + 2, before.begin() + 61),
            std::vector(after.begin() + 2, after.begin() + 61));
  EXPECT_NEAR(after[65] - before[65], 100.0F, 5.0F);
}

TEST(Acquisition, SurvivesTimesThatNoRecordingHas) {
  Session session = made_session();
  session.frames[3].exposure_end = HostTime::max();
  session.frames[4].exposure_begin = HostTime::min();
  session.gyro[5].stamp.time = HostTime::min();
  session.servo[5].stamp.time = HostTime::min();
  session.gyro.back().stamp.time = session.servo.back().stamp.time = HostTime::max();
  const Acquisition acquisition = acquired(session);
  for (const network::RateSeries& series : acquisition.rates)
    EXPECT_TRUE(std::isnan(series.rate_dps[3]) && std::isnan(series.rate_dps[4])) << series.name;
  EXPECT_TRUE(std::isfinite(rates(acquisition, "gyro")[5]));
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
