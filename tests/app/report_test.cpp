// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <fstream>

#include "../report/made_results.h"
#include "program.h"
#include "support/file_text.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;

class Report : public ProgramTest {
 protected:
  /// A study's folder with a result file a job.
  std::filesystem::path study_of(const std::vector<study::JobResult>& results) {
    const auto study = folder() / "study";
    std::filesystem::create_directories(study / "results");
    for (const study::JobResult& result : results)
      std::ofstream(study / "results" / study::file_name_of(result.job)) << study::to_json(result);
    return study;
  }
};

TEST_F(Report, IsDrawnFromResultFilesAlone) {
  const auto study = study_of(made_study());
  const Outcome outcome = run("evaluate --draw " + study.string());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(file_text(study / "report.md"),
              HasSubstr("| 0.0100 (20.0) | 0.0050 (14.1) | 0.0071 | 0.0036 | 6 of 6 |"));
  EXPECT_THAT(file_text(study / "report.html"), HasSubstr("0.0050 (14.1)"));
  EXPECT_EQ(nlohmann::json::parse(file_text(study / "report.json"))["format"], "thermorig-study-report");
}

TEST_F(Report, IsTheSameEachTime) {
  const auto study = study_of({made_result({}), made_result({.fusion = false})});
  ASSERT_EQ(run("evaluate --draw " + study.string()).code, 0);
  const std::string first = file_text(study / "report.html");
  ASSERT_EQ(run("evaluate --draw " + study.string()).code, 0);
  EXPECT_EQ(file_text(study / "report.html"), first);
}

TEST_F(Report, GoesToAnotherFolderWhereAsked) {
  const auto study = study_of({made_result({})});
  const auto other = folder() / "other";
  ASSERT_EQ(run("evaluate --draw " + study.string() + " -o " + other.string()).code, 0);
  EXPECT_TRUE(std::filesystem::exists(other / "report.html"));
  EXPECT_FALSE(std::filesystem::exists(study / "report.html"));
}

TEST_F(Report, OfAnEmptyFolderIsRefused) {
  const Outcome outcome = run("evaluate --draw " + study_of({}).string());
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.err, HasSubstr("results"));
}

TEST_F(Report, OfADamagedResultNamesIt) {
  const auto study = study_of({made_result({})});
  std::ofstream(study / "results" / "broken.json") << "{\"format\": ";
  const Outcome outcome = run("evaluate --draw " + study.string());
  EXPECT_EQ(outcome.code, 8);
  EXPECT_THAT(outcome.err, HasSubstr("broken.json"));
}

}  // namespace
}  // namespace thermorig::tests
