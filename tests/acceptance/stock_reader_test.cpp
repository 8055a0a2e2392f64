// SPDX-License-Identifier: MIT
// Sessions that the program recorded, opened by programs that know nothing of it.
#include <gmock/gmock.h>

#include <fstream>
#include <regex>
#include <sstream>

#include "app/program.h"
#include "support/other_program.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::tests {
namespace {

class FreshSession : public ProgramTest {
 protected:
  FreshSession() : path_(record_briefly()) {}
  const std::filesystem::path path_;
};

const std::string format_page = std::string(THERMORIG_SOURCE_DIR) + "/docs/recording_format.md";

TEST_F(FreshSession, IsInH5pyWhatTheFormatPageSays) {
  if (!python_has("h5py")) GTEST_SKIP() << "needs /usr/bin/python3 with h5py: apt-get install python3-h5py";
  const Printed printed = run_script("acceptance/read_with_h5py.py " + format_page + " " + path_.string());
  EXPECT_EQ(printed.code, 0) << printed.text;
}

TEST_F(FreshSession, HasNamedDimensionsAndCoordinatesInXarray) {
  if (!python_has("xarray, h5netcdf"))
    GTEST_SKIP() << "needs xarray with h5netcdf: apt-get install python3-xarray python3-h5netcdf";
  const Printed printed = run_script("acceptance/read_with_xarray.py " + path_.string());
  EXPECT_EQ(printed.code, 0) << printed.text;
}

TEST_F(FreshSession, IsPlottedByTheLinesOfTheFormatPage) {
  if (!python_has("h5py, matplotlib"))
    GTEST_SKIP() << "needs h5py and matplotlib: apt-get install python3-h5py python3-matplotlib";
  std::ostringstream page;
  page << std::ifstream(format_page).rdbuf();
  std::smatch block;
  const std::string text = page.str();
  ASSERT_TRUE(std::regex_search(text, block, std::regex("```python\n([^`]*)```")));
  std::filesystem::copy_file(path_, folder() / "session.h5");
  std::ofstream(folder() / "plot.py") << block[1];
  const Printed printed =
      run_other("cd " + folder().string() + " && MPLBACKEND=Agg /usr/bin/python3 -W error plot.py");
  // With no screen to show it on, show() warns; everything before it has run then.
  EXPECT_TRUE(printed.code == 0 || printed.text.find("non-interactive") != std::string::npos) << printed.text;
}

class Dumped : public FreshSession {
 protected:
  void SetUp() override {
    if (run_other("h5dump --version").code != 0) GTEST_SKIP() << "needs h5dump: apt-get install hdf5-tools";
  }
};

TEST_F(Dumped, ShowsEveryGroupAndUnitInItsHeader) {
  const Printed header = run_other("h5dump -H " + path_.string());
  ASSERT_EQ(header.code, 0);
  for (const char* part : {"GROUP \"camera\"", "GROUP \"gyro\"", "GROUP \"servo\"", "GROUP \"samples\"",
                           "GROUP \"raw\"", "DATASET \"temperature\"", "DATASET \"rate_shaft\"",
                           "DATASET \"chunk_end\"", "ATTRIBUTE \"units\"", "ATTRIBUTE \"DIMENSION_LIST\""})
    EXPECT_NE(header.text.find(part), std::string::npos) << part;
}

TEST_F(Dumped, GivesTheValuesThatOurReaderGives) {
  const Printed printed = run_other("h5dump -y -w 0 -A 0 -d /samples/leg " + path_.string());
  ASSERT_EQ(printed.code, 0) << printed.text;
  std::smatch data;
  ASSERT_TRUE(std::regex_search(printed.text, data, std::regex("DATA \\{([^}]*)\\}"))) << printed.text;
  std::string numbers = data[1];
  std::replace(numbers.begin(), numbers.end(), ',', ' ');
  std::istringstream stream(numbers);
  std::vector<int> dumped, ours;
  for (int leg = 0; stream >> leg;) dumped.push_back(leg);
  for (const LabelledSample& sample : session::read_session(path_).samples) ours.push_back(sample.leg);
  EXPECT_EQ(dumped, ours);
  EXPECT_EQ(*std::max_element(ours.begin(), ours.end()), 4);
}

}  // namespace
}  // namespace thermorig::tests
