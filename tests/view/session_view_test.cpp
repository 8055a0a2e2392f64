// SPDX-License-Identifier: MIT
#include "thermorig/storage/view/session_view.h"

#include <gmock/gmock.h>

#include <cmath>

#include "columns_of.h"
#include "session/synthetic_session.h"
#include "session/temporary_folder.h"
#include "thermorig/core/error.h"
#include "thermorig/core/image_bytes.h"

namespace thermorig::view {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::size_t frames = 200;

class SessionViews : public session::InTemporaryFolder {
 protected:
  session::Session synthetic() { return session::SyntheticSession(frames, 5).take(); }

  SessionView written(const session::Session& session) {
    session::write_session(path(), session);
    return SessionView(path());
  }

  static nlohmann::json facts_of(const SessionView& view) { return nlohmann::json::parse(view.facts()); }
  static ReadColumns columns_of(const SessionView& view) { return {facts_of(view), view.rows()}; }
};

std::int16_t pixel_at(const std::string& images, std::size_t pixel) {
  std::int16_t value = 0;
  std::memcpy(&value, &images.at(2 * pixel), sizeof value);
  return value;
}

TEST_F(SessionViews, SayWhereASessionComesFromAndWhatBecameOfIt) {
  const session::Session session = synthetic();
  const nlohmann::json facts = facts_of(written(session));
  EXPECT_EQ(facts.at("file"), "one.h5");
  EXPECT_EQ(facts.at("environment"), "garden");
  EXPECT_EQ(facts.at("simulated"), true);
  EXPECT_EQ(facts.at("simulation"), "made for a test");
  EXPECT_EQ(facts.at("frames"), frames);
  const session::Quality quality = session::quality_of(session);
  EXPECT_EQ(facts.at("frames_valid"), quality.valid);
  EXPECT_EQ(facts.at("frames_swept"), quality.swept);
  EXPECT_EQ(facts.at("verdict"), quality.verdict);
  EXPECT_EQ(facts.at("verdict_reasons"), quality.verdict_reasons);
  EXPECT_EQ(facts.at("verdict_altered"), false);
  EXPECT_EQ(facts.at("events").size(), session.raw.events.size());
  EXPECT_EQ(facts.at("legs").size(), session.raw.legs.size());
  EXPECT_EQ(facts.at("reason_names").at(3), "servo_ramp");
}

TEST_F(SessionViews, HaveARowForEachFrame) {
  const session::Session session = synthetic();
  const ReadColumns columns = columns_of(written(session));
  ASSERT_EQ(columns.rows(), frames);
  for (std::size_t row = 1; row < frames; ++row) {
    const LabelledSample& sample = session.samples[row];
    EXPECT_NEAR(columns.at<double>("time_s", row), to_s(sample.time - session.raw.header.time_reference),
                1e-9);
    EXPECT_EQ(columns.at<float>("commanded_dps", row), sample.rate_commanded_dps);
    EXPECT_EQ(columns.at<float>("shaft_dps", row), sample.rate_shaft_dps);
    EXPECT_EQ(columns.at<float>("gyro_dps", row), sample.rate_gyro_dps);
    EXPECT_EQ(columns.at<std::uint32_t>("reasons", row), sample.reason_bits);
    EXPECT_EQ(columns.at<std::uint16_t>("leg", row), sample.leg);
    EXPECT_EQ(columns.at<std::uint8_t>("valid", row), sample.valid ? 1 : 0);
    EXPECT_EQ(columns.at<std::uint8_t>("fresh", row), 1) << "one half of each";
  }
  EXPECT_TRUE(std::isnan(columns.at<float>("gyro_dps", 0)));
  EXPECT_EQ(columns.at<std::uint16_t>("missing", 160), 2);
}

TEST_F(SessionViews, TakeTheCourseOfTheBiasAndTheScaleOffTheGyro) {
  const session::Session session = synthetic();
  const ReadColumns columns = columns_of(written(session));
  const LabelledSample& sample = session.samples[12];
  EXPECT_NEAR(columns.at<float>("corrected_dps", 12),
              (sample.rate_gyro_dps - bias_dps_at(session.sync.gyro, sample.time)) / 1.01, 1e-5);
}

/// The session of a live run that showed frame 20 alone, so much later than the session knows it now.
session::Session with_an_estimate(session::Session session, double later_s) {
  session.raw.header.estimators = paper_columns;
  EstimateRow row;
  row.frame_index = 20;
  row.time = session.samples[20].time + from_s(later_s);
  row.exposure_begin = row.exposure_end = row.arrival = row.time;
  row.rate_commanded_dps = 8.0F;
  session.raw.estimates = {with_rates(row, 12.5F, 7.0F, 9.0F, 0.25F)};
  return session;
}

TEST_F(SessionViews, PutEstimatesBesideTheFramesWhoseTimesTheyHave) {
  const SessionView view = written(with_an_estimate(synthetic(), 0.06));
  EXPECT_EQ(facts_of(view).at("estimators").at(2).at("name"), "cnn-fusion");
  const ReadColumns columns = columns_of(view);
  EXPECT_EQ(columns.at<float>("window_dps", 20), 8.0F);
  EXPECT_EQ(columns.at<float>("estimates.0.rate_dps", 20), 12.5F);
  EXPECT_EQ(columns.at<float>("estimates.2.values.0", 20), 0.25F);
  EXPECT_EQ(columns.at<std::uint8_t>("estimates.2.state", 20), static_cast<int>(EstimateState::good));
  EXPECT_EQ(columns.at<std::uint8_t>("estimates.0.state", 21), 255) << "of no other frame";
  EXPECT_TRUE(std::isnan(columns.at<float>("estimates.0.rate_dps", 21)));
}

TEST_F(SessionViews, LeaveOutEstimatesThatAreHalfAFramePeriodAway) {
  const ReadColumns columns = columns_of(written(with_an_estimate(synthetic(), 0.07)));
  EXPECT_EQ(columns.at<std::uint8_t>("estimates.0.state", 20), 255);
}

TEST_F(SessionViews, HaveNoColumnsOfEstimatorsWhereNoneRan) {
  EXPECT_FALSE(columns_of(written(synthetic())).has("window_dps"));
}

TEST_F(SessionViews, CanHaveARowForEveryThirdFrame) {
  const session::Session session = synthetic();
  session::write_session(path(), session);
  const SessionView view(path(), 3);
  const ReadColumns columns = columns_of(view);
  EXPECT_EQ(facts_of(view).at("rows_every"), 3);
  ASSERT_EQ(columns.rows(), (frames + 2) / 3);
  EXPECT_EQ(view.frames(), frames);
  EXPECT_EQ(columns.at<float>("gyro_dps", 7), session.samples[21].rate_gyro_dps);
}

TEST_F(SessionViews, GiveImagesAsTheyAreInHundredths) {
  session::Session session = synthetic();
  session.raw.header.profile.camera.mirrored = false;
  const SessionView view = written(session);
  const std::string images = view.images({70, 2});
  ASSERT_EQ(images.size(), 2 * image_bytes);
  for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
    ASSERT_EQ(pixel_at(images, frame_pixels + pixel),
              std::lround(100 * session.frames[71].frame.temp_c[pixel]))
        << pixel;
}

TEST_F(SessionViews, ShowTheSceneOfAMirroredCamera) {
  session::Session session = synthetic();
  session.raw.header.profile.camera.mirrored = true;
  const std::string images = written(session).images({0, 1});
  EXPECT_EQ(pixel_at(images, 0), std::lround(100 * session.frames[0].frame.temp_c[frame_columns - 1]));
}

TEST_F(SessionViews, RefuseFramesThatThereAreNot) {
  const SessionView view = written(synthetic());
  EXPECT_THROW(view.images({frames, 1}), Error);
  EXPECT_THROW(view.images({0, frames + 1}), Error);
  EXPECT_THROW(view.images({~0ULL, 2}), Error) << "no number overflows";
  EXPECT_THROW(view.images({0, session::most_images + 1}), Error);
  EXPECT_THAT(view.images({frames, 0}), IsEmpty());
}

TEST_F(SessionViews, AnswerAPageByExactNamesAlone) {
  const SessionView view = written(synthetic());
  EXPECT_EQ(served_part(view, "facts"), view.facts());
  EXPECT_EQ(served_part(view, "rows"), view.rows());
  EXPECT_EQ(served_part(view, "images/1"), view.images({64, 64}));
  EXPECT_EQ(served_part(view, "images/3"), view.images({192, 8})) << "the last block is short";
  for (const char* name : {"", "fact", "facts/", "images", "images/", "images/4", "images/-1", "images/1/2",
                           "images/1 ", "images/0x1", "images/18446744073709551615",
                           "images/18446744073709551616", "images/288230376151711744"})
    EXPECT_EQ(served_part(view, name), std::nullopt) << name;
}

TEST_F(SessionViews, RefuseWhatIsNoSession) {
  write_file(path(), {'n', 'o'});
  try {
    const SessionView view(path());
    FAIL() << "it was taken for a session";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::not_a_session);
    EXPECT_THAT(error.where(), HasSubstr("one.h5"));
  }
}

TEST_F(SessionViews, OfASessionWithoutFramesHaveNoRows) {
  session::write_session(path(), session::SyntheticSession(0, 5).take());
  const SessionView view(path());
  EXPECT_EQ(view.frames(), 0U);
  EXPECT_EQ(columns_of(view).rows(), 0U);
  EXPECT_EQ(served_part(view, "images/0"), std::nullopt);
}

}  // namespace
}  // namespace thermorig::view
