// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "made_results.h"
#include "thermorig/learning/report/report.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

model::Model made_model(bool fusion) {
  model::Model model;
  model.weights.shape.fusion = fusion;
  model.provenance.producer = "thermorig 0.1.0";
  model.provenance.preset = "best";
  model.provenance.label = Label::corrected;
  model.provenance.training = {{"kitchen-1", "a"}, {"</td><script>alert(1)</script>", "b"}};
  model.provenance.simulated = true;
  return model;
}

TEST(EvaluationReport, ShowsAllEstimatorsOfAFusedModel) {
  const auto evaluation = made_result({}).evaluation;
  const std::string text = report::evaluation_markdown(made_model(true), evaluation);
  EXPECT_THAT(text, HasSubstr("| cnn-thermal | 160 | 0.1000 | 63.2 |"));
  EXPECT_THAT(text, HasSubstr("| cnn-fusion | 160 | 0.0100 | 20.0 | 14.0 | 40.0 | 10 % | 0.10 |"));
  EXPECT_THAT(text, HasSubstr("| gyro | 160 | 0.0200 | 28.3 |"));
  EXPECT_THAT(text, HasSubstr("| gyro-rest | 160 | 0.00050 |"));
  EXPECT_THAT(text, HasSubstr("| gyro-kalman | 0 | - |"));
  EXPECT_THAT(text, HasSubstr("against the commanded speed"));
  EXPECT_THAT(text, HasSubstr("against the shaft, by the servo model"));
  EXPECT_THAT(text, HasSubstr("| label | rate\\_corrected |"));
  EXPECT_THAT(text, HasSubstr("trained on SIMULATED data"));
  EXPECT_THAT(text, HasSubstr("0 % below 0.02, 0 % above 0.98: open."));
}

TEST(EvaluationReport, SaysWhatIsSimulatedOfModelAndSessions) {
  study::Evaluation simulated, real;
  simulated.simulated = true;
  model::Model model = made_model(true);
  EXPECT_THAT(report::evaluation_markdown(model, simulated), HasSubstr("and is tested on SIMULATED data"));
  EXPECT_THAT(report::evaluation_markdown(model, real), Not(HasSubstr("tested on")));
  model.provenance.simulated = false;
  EXPECT_THAT(report::evaluation_markdown(model, simulated), HasSubstr("**The model is tested on SIMULATED"));
  EXPECT_THAT(report::evaluation_markdown(model, real), Not(HasSubstr("SIMULATED")));
}

TEST(EvaluationReport, LeavesFusionAndGateOutOfAThermalOnlyModel) {
  const auto evaluation = made_result({.fusion = false}).evaluation;
  const std::string text = report::evaluation_markdown(made_model(false), evaluation);
  EXPECT_THAT(text, HasSubstr("| cnn-thermal | 160 | 0.0100 |"));
  EXPECT_THAT(text, Not(HasSubstr("| cnn-fusion |")));
  EXPECT_THAT(text, Not(HasSubstr("The gate Kg")));
}

TEST(EvaluationReport, IsAPageThatHostileModelsCannotBreak) {
  const std::string page = report::evaluation_html(made_model(true), made_result({}).evaluation);
  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(page, HasSubstr("&lt;/td&gt;&lt;script&gt;alert(1)"));
  EXPECT_THAT(page, HasSubstr("Error by speed"));
}

TEST(EvaluationReport, HoldsItsNumbersAsJson) {
  const auto evaluation = made_result({}).evaluation;
  const auto json = nlohmann::json::parse(report::evaluation_json(made_model(true), evaluation));
  EXPECT_EQ(json["errors"]["cnn-fusion"]["mse"], 0.01);
  EXPECT_EQ(json["shaft_errors"]["cnn-fusion"]["windows"], 0);
  EXPECT_EQ(json["model"]["label"], "corrected");
  EXPECT_EQ(json["speeds"].size(), 4U);
  EXPECT_EQ(json["speeds"][0]["rate_dps"], -200.0);
  EXPECT_EQ(json["angles"][0]["name"], "garden-1");
  EXPECT_EQ(json["angles"][0]["estimators"]["gyro"]["drift_deg_per_min"], -60.0);
  EXPECT_EQ(json["model"]["weights"], 750274);
}

TEST(EvaluationReport, IsDrawnOfNothing) {
  study::Evaluation empty;
  EXPECT_THAT(report::evaluation_markdown(made_model(true), empty), HasSubstr("No windows with a speed."));
}

}  // namespace
}  // namespace thermorig::tests
