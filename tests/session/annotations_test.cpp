// SPDX-License-Identifier: MIT
#include "thermorig/storage/session/annotations.h"

#include <gtest/gtest.h>

#include "equality.h"
#include "synthetic_session.h"
#include "temporary_folder.h"
#include "thermorig/core/error.h"

namespace thermorig::session {
namespace {

const Annotation said{.made_utc = "2026-11-23T20:00:00Z", .text = "the window was open"};
const Annotation moved{.kind = AnnotationKind::environment,
                       .made_utc = "2026-11-23T20:01:00Z",
                       .text = "kitchen",
                       .acquisition = 7};

Annotation excluded(double begin_s, double end_s) {
  return {.kind = AnnotationKind::exclusion,
          .made_utc = "2026-11-23T20:02:00Z",
          .text = "",
          .begin_s = begin_s,
          .end_s = end_s};
}

/// Twenty valid frames of one leg, 0.1 s each, from second 0 on.
Session with_frames() {
  Session session = SyntheticSession(20, 1).take();
  for (std::size_t i = 0; i < session.samples.size(); ++i) {
    LabelledSample& sample = session.samples[i];
    sample.exposure_begin = session.raw.header.time_reference + from_s(0.1 * static_cast<double>(i));
    sample.exposure_end = sample.exposure_begin + from_s(0.1);
    sample.reason_bits = 0;
    sample.leg = 1;
    sample.run = 1;
    sample.valid = true;
  }
  return session;
}

std::vector<std::uint32_t> runs_of(const Session& session) {
  std::vector<std::uint32_t> runs;
  for (const LabelledSample& sample : session.samples) runs.push_back(sample.run);
  return runs;
}

using Annotations = InTemporaryFolder;

TEST_F(Annotations, AreReadBackAndTheHeaderStaysAsRecorded) {
  Session session = with_frames();
  session.annotations = {said, moved, excluded(-0.5, 0.25)};
  write_session(path("a.h5"), session);
  const Session read = read_session(path("a.h5"));
  EXPECT_EQ(read.annotations, session.annotations);
  EXPECT_EQ(read.raw.header.environment, "garden");
  EXPECT_EQ(place_of(read), (Place{"kitchen", 7}));
  EXPECT_EQ(read.format_major, 2U);
}

TEST_F(Annotations, AreNotInAFileWithoutAny) {
  write_session(path("a.h5"), with_frames());
  EXPECT_TRUE(read_session(path("a.h5")).annotations.empty());
  EXPECT_EQ(place_of(with_frames()), (Place{"garden", 2}));
}

TEST_F(Annotations, ThatNobodyMayHaveMadeAreRefused) {
  for (const Annotation& bad :
       {Annotation{.made_utc = "today", .text = "two\nlines"}, excluded(2.0, 1.0), excluded(0.0, 1e300),
        Annotation{
            .kind = AnnotationKind::environment, .made_utc = "today", .text = "../up", .acquisition = 1},
        Annotation{
            .kind = AnnotationKind::environment, .made_utc = "today", .text = "attic", .acquisition = 0}}) {
    EXPECT_TRUE(problem_of(bad)) << bad.text;
    Session session = with_frames();
    session.annotations = {bad};
    EXPECT_THROW(write_session(path("b.h5"), session), Error) << bad.text;  // what could not be read again
  }
}

TEST(Exclusion, MarksEveryFrameThatWasExposedInItAndSplitsTheRun) {
  Session session = with_frames();
  session.annotations = {excluded(0.55, 0.75)};
  apply_exclusions(session);
  for (std::size_t i = 0; i < 20; ++i) {
    const bool is_within = i >= 5 && i <= 7;
    EXPECT_EQ(session.samples[i].valid, !is_within) << i;
    EXPECT_EQ(session.samples[i].reason_bits, is_within ? bit(Reason::operator_mark) : 0U) << i;
    EXPECT_EQ(session.samples[i].run, is_within ? 0U : i < 5 ? 1U : 2U) << i;
  }
}

TEST(Exclusion, TakenBackLeavesFramesAsTheyWere) {
  Session session = with_frames();
  session.samples[6].reason_bits = bit(Reason::servo_ramp);  // for another reason as well
  session.samples[6].valid = false;
  session.samples[9].reason_bits = bit(Reason::warm_up);  // a warning
  for (std::size_t i = 6; i < 20; ++i) session.samples[i].run = i == 6 ? 0 : 2;
  const std::vector<std::uint32_t> runs = runs_of(session);
  const std::vector<LabelledSample> before = session.samples;
  session.annotations = {excluded(0.0, 1.5)};
  apply_exclusions(session);
  EXPECT_FALSE(session.samples[9].valid);
  session.annotations.clear();
  apply_exclusions(session);
  EXPECT_TRUE(same(session.samples, before));
  EXPECT_EQ(runs_of(session), runs);
}

TEST(Exclusion, LeavesASessionWithoutOneAlone) {
  Session session = with_frames();
  for (LabelledSample& sample : session.samples) sample.run = 4;  // as an older version may have numbered it
  session.annotations = {said};
  apply_exclusions(session);
  EXPECT_EQ(runs_of(session), std::vector<std::uint32_t>(20, 4));
}

}  // namespace
}  // namespace thermorig::session
