// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "made_results.h"
#include "thermorig/learning/report/report.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string hostile = "</script><script>alert(1)</script><!-- '\"><img src=x onerror=alert(1)> \xff";

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

/// The page without what was bundled into it: style, script and licences.
std::string content_of(const std::string& page) {
  const auto first = page.find("<main>"), last = page.find("</main>");
  return page.substr(first, last - first);
}

nlohmann::json charts_of(const std::string& page) {
  const std::string open = "<script type=\"application/json\" id=\"charts\">";
  const auto first = page.find(open) + open.size();
  return nlohmann::json::parse(page.substr(first, page.find("</script>", first) - first));
}

TEST(Page, IsWholeAndLoadsNothing) {
  const std::string page = report::study_html(made_study());
  EXPECT_TRUE(page.starts_with("<!doctype html>"));
  EXPECT_THAT(page, HasSubstr("</html>"));
  EXPECT_THAT(page,
              HasSubstr("http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src "
                        "'sha256-"));
  EXPECT_EQ(count(page, "<script"), 2U);
  EXPECT_EQ(count(page, "<link"), 0U);
  EXPECT_EQ(count(content_of(page), "src="), 0U);
  EXPECT_EQ(count(content_of(page), "http"), 0U);
  EXPECT_THAT(page, Not(HasSubstr("{{")));
}

TEST(Page, IsSmallerThanAMegabyte) {
  EXPECT_LT(report::study_html(made_study()).size(), 1'000'000U);
}

TEST(Page, HasTheSameTablesAsTheMarkdown) {
  const std::string page = report::study_html(made_study());
  EXPECT_THAT(page, HasSubstr("<th scope=\"row\">3</th><td class=\"number\">0.005</td>"));
  EXPECT_THAT(page, HasSubstr("<td class=\"number\">0.0050 (14.1)</td>"));
  EXPECT_THAT(page, HasSubstr("<th scope=\"colgroup\" colspan=\"4\">paper, real data</th>"));
  EXPECT_THAT(page, HasSubstr("gyro-rest (Nf = 3)"));
  EXPECT_THAT(page, HasSubstr("class=\"banner\">SIMULATED"));
  EXPECT_THAT(page, HasSubstr("<strong>does not hold</strong>"));
}

TEST(Page, KeepsTheLicenceOfTheChartLibrary) {
  const std::string page = report::study_html(made_study());
  EXPECT_THAT(page, HasSubstr("Apache License"));
  EXPECT_THAT(page, HasSubstr("Copyright 2017-"));
  EXPECT_THAT(page, HasSubstr("Copyright (c) 2017, Baidu Inc."));
}

TEST(Page, DescribesEveryChartInWords) {
  const std::string page = report::study_html(made_study());
  const std::string content = content_of(page);
  const auto charts = charts_of(page);
  EXPECT_EQ(count(content, "role=\"img\""), charts.size());
  EXPECT_EQ(count(content, "aria-label=\"\""), 0U);
  EXPECT_THAT(content,
              HasSubstr("aria-label=\"Histogram of Kg over 960 windows: mean 0.55, peak at 0.575.\""));
}

TEST(Page, HoldsTheFoldsAsPointsOfTheBoxPlots) {
  const auto charts = charts_of(report::study_html(made_study()));
  ASSERT_EQ(charts[0]["kind"], "boxes");
  EXPECT_EQ(charts[0]["categories"], nlohmann::json({"2", "3", "4", "5", "6"}));
  EXPECT_EQ(charts[0]["boxes"][1]["points"][1].size(), 6U);
  EXPECT_EQ(charts[0]["boxes"][1]["points"][1][0]["fold"], "garden-1");
  EXPECT_NEAR(charts[0]["boxes"][1]["points"][1][0]["mse"], 0.005 / 3.5, 1e-6);
  EXPECT_EQ(charts[0]["paper"][1]["values"], nlohmann::json({0.008, 0.005, 0.005, 0.008, 0.009}));
  EXPECT_EQ(charts[1]["categories"], nlohmann::json({"1", "2", "3"}));
}

TEST(Page, DrawsAllLinesOfAnAngleOverTheirOwnTime) {
  const auto charts = charts_of(report::study_html(std::vector{made_result({})}));
  std::size_t lines = 0;
  for (const auto& chart : charts)
    if (chart["kind"] == "lines")
      for (const auto& line : chart["lines"]) {
        ++lines;
        EXPECT_EQ(line["x"].size(), line["y"].size()) << line["name"];
      }
  EXPECT_GT(lines, 6U);
}

TEST(Page, DrawsCostsOfTheSettingsThatWereRunAlone) {
  std::size_t bars = 0;
  for (const auto& chart : charts_of(report::study_html(std::vector{made_result({})})))
    if (chart["kind"] == "bars") {
      ++bars;
      EXPECT_EQ(chart["categories"], nlohmann::json::array({"1"}));
    }
  EXPECT_EQ(bars, 2U);
}

TEST(Page, CannotBeInjectedInto) {
  auto results = std::vector{made_result({.fold = hostile})};
  results[0].job.preset = results[0].job.settings = results[0].instruction_set = hostile;
  results[0].job.data_hash = hostile;
  const std::string page = report::study_html(results);
  EXPECT_EQ(count(page, "<script"), 2U);
  EXPECT_EQ(count(page, "alert(1)</script>"), 0U);
  EXPECT_EQ(count(content_of(page), "<img"), 0U);
  EXPECT_EQ(count(content_of(page), "<!--"), 0U);
  EXPECT_THAT(page, HasSubstr("&lt;/script&gt;&lt;script&gt;alert(1)"));
  EXPECT_THAT(page, Not(HasSubstr("\xff")));
  const std::string fold = charts_of(page)[0]["boxes"][1]["points"][1][0]["fold"];
  EXPECT_THAT(fold, HasSubstr("</script><script>alert(1)</script>"));
}

TEST(Page, ShowsNothingForWhatIsNotANumber) {
  auto results = std::vector{made_result({})};
  for (const std::string& name : study::all_estimators()) {
    study::Errors& errors = results[0].evaluation.errors[name];
    errors.mse = errors.rmse_dps = std::nan("");
  }
  for (auto& speed : results[0].evaluation.speeds) speed.mse = study::PerEstimator<double>(std::nan(""));
  results[0].evaluation.angles.clear();
  results[0].training_mse = {std::nan("")};
  const std::string page = report::study_html(results);
  EXPECT_EQ(count(content_of(page), ">nan"), 0U);
  EXPECT_EQ(count(content_of(page), "inf<"), 0U);
  EXPECT_TRUE(charts_of(page)[0]["boxes"][1]["points"][1][0]["mse"].is_null());
}

}  // namespace
}  // namespace thermorig::tests
