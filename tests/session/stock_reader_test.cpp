// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <limits>

#include "equality.h"
#include "format_1_file.h"
#include "replace_session.h"
#include "support/other_program.h"
#include "synthetic_session.h"
#include "temporary_folder.h"
#include "thermorig/storage/session/session.h"
#include "thermorig/storage/session/trial.h"

namespace thermorig::session {
namespace {

/// Sessions as h5py sees them.
class StockReader : public InTemporaryFolder {
 protected:
  void SetUp() override {
    InTemporaryFolder::SetUp();
    if (!tests::python_has("h5py"))
      GTEST_SKIP() << "needs /usr/bin/python3 with h5py: apt-get install python3-h5py";
  }

  static tests::Printed check(const std::string& arguments) {
    return tests::run_script("session/check_schema.py " + arguments);
  }
};

TEST_F(StockReader, FindsNamesUnitsScalesFiltersAndValues) {
  write_session(path(), synthetic_session(150));
  const tests::Printed output = check(path().string() + " 150");
  EXPECT_EQ(output.code, 0) << output.text;
}

TEST_F(StockReader, MayStateTheLicenceOfASessionThatHasNone) {
  Session session = synthetic_session(20);
  session.raw.header.licence.clear();
  write_session(path(), session);
  EXPECT_EQ(read_session(path()).raw.header.licence, "");
  const tests::Printed output =
      tests::run_script("session/state_licence.py " + path().string() + " ODbL-1.0");
  ASSERT_EQ(output.code, 0) << output.text;
  EXPECT_THAT(output.text, testing::HasSubstr("was: not stated"));
  EXPECT_EQ(read_session(path()).raw.header.licence, "ODbL-1.0");
  EXPECT_EQ(read_raw(path()).header.licence, "ODbL-1.0");
}

TEST_F(StockReader, MayStateALicenceInAnyKindOfText) {
  for (const char* kind : {"variable", "ascii", "zeros"}) {
    write_session(path(kind), synthetic_session(20));
    const tests::Printed output =
        tests::run_script("session/state_licence.py " + path(kind).string() + " ODbL-1.0 " + kind);
    ASSERT_EQ(output.code, 0) << output.text;
    EXPECT_EQ(read_session(path(kind)).raw.header.licence, "ODbL-1.0") << kind;
  }
}

TEST_F(StockReader, MayAddAttributesThatStayWhenTheSessionIsReplaced) {
  write_session(path(), synthetic_session(20));
  const tests::Printed added = tests::run_script("session/added_attributes.py add " + path().string());
  ASSERT_EQ(added.code, 0) << added.text;
  for (const int seed : {2, 3}) {
    replace_session(path(), synthetic_session(20, seed));
    EXPECT_THAT(altered_attributes(StoredFile(path())), testing::IsEmpty());
    const tests::Printed output = tests::run_script("session/added_attributes.py check " + path().string());
    EXPECT_EQ(output.code, 0) << output.text;
  }
}

TEST_F(StockReader, MayAddGroupsAndDatasetsThatAreNamedWhenTheyGo) {
  write_session(path(), synthetic_session(20));
  const std::string add = fmt::format(
      "import h5py; f = h5py.File(\"{}\", \"r+\"); f.create_group(\"notes/by_hand\"); f[\"notes/weather\"] = "
      "3; "
      "f[\"gyro/filtered\"] = [1.0, 2.0]",
      path().string());
  ASSERT_EQ(tests::run_python(add).code, 0);
  EXPECT_THAT(replace_session(path(), synthetic_session(20)),
              testing::UnorderedElementsAre("/gyro/filtered", "/notes"));
  EXPECT_THAT(replace_session(path(), synthetic_live_session(150)), testing::IsEmpty());
  EXPECT_THAT(replace_session(path(), synthetic_session(20)), testing::IsEmpty());
}

TEST_F(StockReader, FindsTheRowsOfALiveRun) {
  write_session(path(), synthetic_live_session(150));
  const tests::Printed output = check(path().string() + " 150");
  EXPECT_EQ(output.code, 0) << output.text;
}

TEST_F(StockReader, ReadsASessionInWhichNothingCame) {
  write_session(path(), synthetic_session(0));
  const tests::Printed output = check(path().string() + " 0");
  EXPECT_EQ(output.code, 0) << output.text;
}

TEST_F(StockReader, FindsEqualDatasetsInTwoFilesOfOneSession) {
  write_session(path("a.h5"), synthetic_session(100));
  write_session(path("b.h5"), synthetic_session(100));
  const tests::Printed first = check("--digest " + path("a.h5").string());
  EXPECT_EQ(first.code, 0);
  EXPECT_THAT(first.text, testing::HasSubstr("/samples/rate_shaft "));
  EXPECT_EQ(first.text, check("--digest " + path("b.h5").string()).text);
  write_session(path("c.h5"), synthetic_session(100, 2));
  EXPECT_NE(first.text, check("--digest " + path("c.h5").string()).text);
}

TEST_F(StockReader, FindsHowHardTheSceneIsAndWhichChecksumsWereAsked) {
  const std::string source = fmt::format(
      "import h5py; f = h5py.File(\"{}\"); a = []; "
      "f.visititems(lambda n, o: a.extend(str(v) for k, v in o.attrs.items() if k in (\"difficulty\", "
      "\"checksum\"))); print(sorted(a))",
      path().string());
  const auto attributes = [&](const char* environment, ChecksumPolicy policy) {
    Session session = synthetic_session(3);
    session.raw.header.environment = environment;
    session.raw.header.profile.camera.checksum = policy;
    std::filesystem::remove(path());
    write_session(path(), session);
    return tests::run_python(source).text;
  };
  EXPECT_EQ(attributes("laboratory", ChecksumPolicy::word), "['low', 'word']\n");
  EXPECT_EQ(attributes("kitchen", ChecksumPolicy::byte), "['byte', 'medium']\n");
  EXPECT_EQ(attributes("garden", ChecksumPolicy::ignore), "['high', 'ignore']\n");
  EXPECT_EQ(attributes("cellar", ChecksumPolicy::word), "['unknown', 'word']\n");
}

/// The session as format 1.0.0 held it.
Session without_what_is_new(Session session) {
  const auto forget = [](auto& rows) {
    for (auto& row : rows) row.stamp.earlier_s = row.stamp.later_s = 0.0F;
  };
  forget(session.frames);
  forget(session.gyro);
  forget(session.servo);
  forget(session.shaft);
  constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
  for (auto& frame : session.frames) frame.half = {};
  for (auto& sample : session.samples) {
    sample.rate_commanded_dps = sample.rate_shaft_dps;
    sample.rate_shaft_half_dps = sample.rate_commanded_half_dps = {unknown, unknown};
    sample.rate_gyro_half_dps = {unknown, unknown};
    sample.gyro_spread_dps = unknown;
  }
  forget_later_labels(session);
  session.sync = {};
  return session;
}

TEST_F(StockReader, LiveRowsOfFormat1AreThoseOfThePapersThreeEstimators) {
  Session session = synthetic_live_session(70);
  write_format_1(path(), session);
  const tests::Printed output = tests::run_script("session/estimates_as_format_1.py " + path().string());
  ASSERT_EQ(output.code, 0) << output.text;
  for (EstimateRow& row : session.raw.estimates)
    row = with_rates(row, gyro_dps(row), thermal_dps(row), fusion_dps(row), kg(row));
  EXPECT_EQ(difference(session.raw, read_raw(path())), "");
}

TEST_F(StockReader, SessionsOfFormat1_0AreStillRead) {
  const Session session = synthetic_session(70);
  write_format_1(path(), session);
  const tests::Printed output = tests::run_script("session/as_format_1_0.py " + path().string());
  ASSERT_EQ(output.code, 0) << output.text;
  const Session read = read_session(path());
  EXPECT_EQ(difference(without_what_is_new(session), read), "");
  EXPECT_EQ(read.label_version, 1U);
  EXPECT_EQ(difference(session.raw, read_raw(path())), "");
  const RigProfile assumed;
  EXPECT_EQ(read.raw.header.profile.camera.link.latency_uncertainty_s,
            assumed.camera.link.latency_uncertainty_s);
  EXPECT_EQ(read.raw.header.profile.gyro.scale_uncertainty, assumed.gyro.scale_uncertainty);
  replace_session(path(), read);
  write_session(path("new.h5"), read_session(path()));
  EXPECT_TRUE(read_file(path()) == read_file(path("new.h5"))) << "something of format 1.0 was kept";
}

TEST_F(StockReader, SessionsOfFormatsBeforeTheCorrectedLabelAreReadWithoutIt) {
  const Session session = synthetic_session(70);
  const Session kept = format_2_0_session(session);
  write_format_2_0(path(), session);
  const Session read = read_session(path());
  EXPECT_EQ(difference(kept, read), "");
  EXPECT_EQ(read.label_version, 2U);
  EXPECT_TRUE(std::isnan(read.samples[10].rate_corrected_dps));
  EXPECT_EQ(difference(session.raw, read_raw(path())), "");  // from which the label can be made
  replace_session(path(), session);
  EXPECT_EQ(read_session(path()).label_version, 3U);
}

TEST_F(StockReader, FindsTheProfileInAGroupForEachTable) {
  write_session(path(), synthetic_session(3));
  const tests::Printed output = tests::run_python(
      fmt::format("import h5py; p = h5py.File(\"{}\")[\"rig/profile\"]; g = p[\"gyro\"].attrs; "
                  "print(p.attrs[\"name\"], p[\"camera\"].attrs[\"baud\"], g[\"axis\"], g[\"scale\"], "
                  "p[\"gyro/text\"].attrs[\"time_column\"], len(p[\"servo\"].attrs))",
                  path().string()));
  EXPECT_EQ(output.text, "rig 460800 z 1.0 -1 25\n");
}

}  // namespace
}  // namespace thermorig::session
