// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <array>
#include <cstdio>
#include <limits>

#include "equality.h"
#include "synthetic_session.h"
#include "temporary_folder.h"
#include "thermorig/session/session.h"

namespace thermorig::session {
namespace {

struct Output {
  std::string text;
  int status = -1;
};

Output run(const std::string& command) {
  Output output;
  FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return output;
  std::array<char, 4096> buffer{};
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    output.text.append(buffer.data(), count);
  output.status = ::pclose(pipe);
  return output;
}

/// Debian's Python with its h5py: another program than ours, with the stock filters.
class StockReader : public InTemporaryFolder {
 protected:
  void SetUp() override {
    InTemporaryFolder::SetUp();
    if (run("/usr/bin/python3 -c 'import h5py'").status != 0)
      GTEST_SKIP() << "needs /usr/bin/python3 with h5py: apt-get install python3-h5py";
  }

  static Output check(const std::string& arguments) {
    return run(
        fmt::format("/usr/bin/python3 {}/tests/session/check_schema.py {}", THERMORIG_SOURCE_DIR, arguments));
  }
};

TEST_F(StockReader, FindsNamesUnitsScalesFiltersAndValues) {
  write_session(path(), synthetic_session(150));
  const Output output = check(path().string() + " 150");
  EXPECT_EQ(output.status, 0) << output.text;
}

TEST_F(StockReader, FindsTheRowsOfALiveRun) {
  write_session(path(), synthetic_live_session(150));
  const Output output = check(path().string() + " 150");
  EXPECT_EQ(output.status, 0) << output.text;
}

TEST_F(StockReader, ReadsASessionInWhichNothingCame) {
  write_session(path(), synthetic_session(0));
  const Output output = check(path().string() + " 0");
  EXPECT_EQ(output.status, 0) << output.text;
}

TEST_F(StockReader, FindsEqualDatasetsInTwoFilesOfOneSession) {
  write_session(path("a.h5"), synthetic_session(100));
  write_session(path("b.h5"), synthetic_session(100));
  const Output first = check("--digest " + path("a.h5").string());
  EXPECT_EQ(first.status, 0);
  EXPECT_THAT(first.text, testing::HasSubstr("/samples/rate_label "));
  EXPECT_EQ(first.text, check("--digest " + path("b.h5").string()).text);
  write_session(path("c.h5"), synthetic_session(100, 2));
  EXPECT_NE(first.text, check("--digest " + path("c.h5").string()).text);
}

/// The session as format 1.0.0 held it.
Session without_what_is_new(Session session) {
  const auto forget = [](auto& rows) {
    for (auto& row : rows) row.stamp.earlier_s = row.stamp.later_s = 0.0F;
  };
  forget(session.frames);
  forget(session.gyro);
  forget(session.servo);
  constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
  for (auto& frame : session.frames) frame.half = {};
  for (auto& sample : session.samples) {
    sample.rate_commanded_dps = sample.rate_label_dps;
    sample.rate_label_half_dps = sample.rate_commanded_half_dps = {unknown, unknown};
    sample.rate_gyro_half_dps = {unknown, unknown};
    sample.gyro_spread_dps = unknown;
  }
  session.sync = {};
  return session;
}

TEST_F(StockReader, SessionsOfFormat1_0AreStillRead) {
  const Session session = synthetic_session(70);
  write_session(path(), session);
  const Output output = run(fmt::format("/usr/bin/python3 {}/tests/session/as_format_1_0.py {}",
                                        THERMORIG_SOURCE_DIR, path().string()));
  ASSERT_EQ(output.status, 0) << output.text;
  const Session read = read_session(path());
  EXPECT_EQ(difference(without_what_is_new(session), read), "");
  EXPECT_EQ(difference(session.raw, read_raw(path())), "");
  const RigProfile assumed;
  EXPECT_EQ(read.raw.header.profile.camera.link.latency_uncertainty_s,
            assumed.camera.link.latency_uncertainty_s);
  EXPECT_EQ(read.raw.header.profile.gyro.scale_uncertainty, assumed.gyro.scale_uncertainty);
}

}  // namespace
}  // namespace thermorig::session
