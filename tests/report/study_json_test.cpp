// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "made_results.h"
#include "thermorig/learning/report/report.h"

namespace thermorig::tests {
namespace {

using nlohmann::json;

json setting_of(const json& report, int frames, int reduction, bool fusion, std::uint64_t seed) {
  for (const json& setting : report["studies"][0]["settings"])
    if (setting["frames"] == frames && setting["reduction"] == reduction && setting["fusion"] == fusion &&
        setting["seed"] == seed)
      return setting;
  return nullptr;
}

TEST(StudyJson, HoldsEveryFoldAsItWas) {
  const auto results = made_study();
  const json report = json::parse(report::study_json(results));
  for (const study::JobResult& result : results) {
    const study::Job& job = result.job;
    const json setting = setting_of(report, job.frames, job.reduction, job.fusion, job.seed);
    ASSERT_FALSE(setting.is_null()) << job.frames << ' ' << job.reduction;
    for (const json& fold : setting["folds"]) {
      if (fold["test"] != job.test) continue;
      EXPECT_EQ(fold["errors"]["gyro"]["mse"], result.evaluation.errors["gyro"].mse);
      EXPECT_EQ(fold["errors"][job.fusion ? "cnn-fusion" : "cnn-thermal"]["mse"],
                result.evaluation.errors[job.fusion ? "cnn-fusion" : "cnn-thermal"].mse);
      EXPECT_EQ(fold["errors"]["cnn-thermal"]["windows"], result.evaluation.errors["cnn-thermal"].windows);
      EXPECT_EQ(fold["angle"]["estimators"]["gyro"]["drift_deg_per_min"], -60.0);
    }
  }
}

TEST(StudyJson, HoldsMediansSpreadsAndCosts) {
  const json report = json::parse(report::study_json(made_study()));
  const json setting = setting_of(report, 3, 1, true, 1);
  EXPECT_NEAR(setting["estimators"]["cnn-fusion"]["median_mse"], 0.005, 1e-12);
  EXPECT_NEAR(setting["estimators"]["cnn-fusion"]["iqr_mse"], 0.005 * 2.5 / 3.5, 1e-12);
  EXPECT_NEAR(setting["estimators"]["cnn-fusion"]["rmse_dps"], 14.142, 1e-3);
  EXPECT_EQ(setting["weights"], 750274);
  EXPECT_EQ(setting["multiply_adds"], 1553480);
  EXPECT_EQ(setting["folds_done"], 6);
  EXPECT_EQ(setting["gain"]["collapsed"], false);
  EXPECT_EQ(setting["gain"]["histogram"][11], 6 * 160);
}

TEST(StudyJson, SaysWhatTheNumbersAre) {
  const json report = json::parse(report::study_json(made_study()));
  EXPECT_EQ(report["format"], "thermorig-study-report");
  EXPECT_EQ(report["paper"]["data"], "real");
  EXPECT_EQ(report["paper"]["rows"].size(), 7U);
  const json study = report["studies"][0];
  EXPECT_EQ(study["simulated"], true);
  EXPECT_EQ(study["label_scale_dps"], 200.0);
  EXPECT_EQ(study["epochs"], 40);
  EXPECT_EQ(study["seeds"], json({1, 2, 3}));
  EXPECT_EQ(study["folds"].size(), 6U);
}

TEST(StudyJson, WritesNullForWhatIsNotKnown) {
  const json report = json::parse(report::study_json(std::vector{made_result({.fusion = false})}));
  const json setting = report["studies"][0]["settings"][0];
  EXPECT_TRUE(setting["folds"][0]["errors"]["cnn-fusion"]["mse"].is_null());
  EXPECT_TRUE(setting["gain"].is_null());
}

TEST(StudyJson, ParsesWithHostileNames) {
  const std::string text = report::study_json(std::vector{made_result({.fold = "a\"b\\\xff\n</script>"})});
  EXPECT_EQ(json::parse(text)["studies"][0]["folds"][0], "a\"b\\\xef\xbf\xbd\n</script>");
}

}  // namespace
}  // namespace thermorig::tests
