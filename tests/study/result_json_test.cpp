// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "estimates_of.h"
#include "thermorig/core/error.h"
#include "thermorig/learning/study/study.h"

namespace thermorig::study {
namespace {

using nlohmann::json;

/// As large as one of the paper's: 50 speeds, an angle of 120 points.
JobResult paper_sized() {
  network::Acquisition acquisition = plain_acquisition("garden_acq-01", 2600, 100.0F);
  std::mt19937_64 random(1);
  std::vector<JudgedWindow> estimates;
  for (std::uint32_t i = 1; i < 2600; ++i) {
    acquisition.leg_rate_dps[i] = static_cast<float>(i / 52) * 8.1F - 200.0F;
    const auto error = [&] { return static_cast<float>(random() % 100'000) * 1e-3F - 50.0F; };
    estimates.push_back(judged(i, acquisition.leg_rate_dps[i], error(), error(), error(),
                               static_cast<float>(random() % 1000) * 1e-3F));
    for (const char* const name : {"gyro-rest", "gyro-kalman", "odometer", "thermal-likelihood"})
      estimates.back().rate_dps[name] = acquisition.leg_rate_dps[i] + error();
  }
  JobResult result;
  result.job.preset = "paper";
  result.job.test = acquisition.name;
  result.job.test_hash = result.job.data_hash = std::string(64, 'a');
  result.evaluation = evaluate(estimates, std::span(&acquisition, 1), {.angle_points = 120});
  result.training_mse.assign(40, 0.1 / 3.0);
  result.instruction_set = "AVX-512";
  return result;
}

std::string refusal(const std::string& text) {
  try {
    result_from_json(text, "file");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::not_a_session);
    EXPECT_EQ(error.where(), "file");
    return error.what_happened();
  }
  return "";
}

/// As version 4 wrote it, which had no sum.
json before_sums(json result) {
  result["version"] = 4;
  result.erase("sum");
  return result;
}

TEST(ResultJson, IsReadBackEqual) {
  const JobResult result = paper_sized();
  const std::string text = to_json(result);
  const JobResult back = result_from_json(text, "");
  EXPECT_EQ(to_json(back), text);
  EXPECT_EQ(back.job, result.job);
  EXPECT_EQ(back.evaluation.errors[thermal_name].mse, result.evaluation.errors[thermal_name].mse);
  EXPECT_EQ(back.evaluation.speeds.size(), 50U);
  EXPECT_EQ(back.evaluation.gain.histogram, result.evaluation.gain.histogram);
  EXPECT_EQ(back.evaluation.angles.at(0).error_deg.values(),
            result.evaluation.angles.at(0).error_deg.values());
  EXPECT_EQ(back.training_mse, result.training_mse);
}

TEST(ResultJson, KeepsExtremeNumbersAndUnknownOnes) {
  JobResult result = paper_sized();
  result.job.seed = std::numeric_limits<std::uint64_t>::max();
  result.seconds = std::numeric_limits<double>::denorm_min();
  result.evaluation.errors[thermal_name].mse = std::numeric_limits<double>::max();
  result.evaluation.errors["gyro-rest"].mse = std::nan("");
  const JobResult back = result_from_json(to_json(result), "");
  EXPECT_EQ(back.job.seed, result.job.seed);
  EXPECT_EQ(back.seconds, result.seconds);
  EXPECT_EQ(back.evaluation.errors[thermal_name].mse, result.evaluation.errors[thermal_name].mse);
  EXPECT_TRUE(std::isnan(back.evaluation.errors["gyro-rest"].mse));
}

TEST(ResultJson, StaysSmall) {
  EXPECT_LT(to_json(paper_sized()).size(), 22'000U);
}

TEST(ResultJson, IsRefusedWhenCutShort) {
  const std::string text = to_json(paper_sized());
  for (std::size_t length = 0; length + 2 < text.size(); length += 97)
    EXPECT_NE(refusal(text.substr(0, length)), "") << length;
}

TEST(ResultJson, IsRefusedWithoutAnyOfItsFields) {
  const json whole = json::parse(to_json(paper_sized()));
  const json flat = whole.flatten();
  for (const auto& [path, value] : flat.items()) {
    const json::json_pointer pointer(path);
    if (!whole[pointer.parent_pointer()].is_object()) continue;  // a shorter list: see below
    json less = before_sums(whole);
    if (!less[pointer.parent_pointer()].erase(pointer.back())) continue;
    EXPECT_NE(refusal(less.dump()), "") << path;
  }
}

TEST(ResultJson, IsRefusedWithValuesOfAnotherKind) {
  const json whole = json::parse(to_json(paper_sized()));
  const json flat = whole.flatten();
  std::size_t count = 0;
  for (const auto& [path, value] : flat.items()) {
    if (++count % 7 != 0) continue;  // a sample: there are a thousand
    json other = before_sums(whole);
    other[json::json_pointer(path)] = json::object();
    EXPECT_NE(refusal(other.dump()), "") << path;
  }
}

TEST(ResultJson, IsRefusedWithListsOfAnotherLength) {
  for (const char* const path :
       {"/estimators", "/evaluation/errors", "/evaluation/speeds/0/mse", "/evaluation/gain/histogram",
        "/evaluation/names", "/evaluation/angles/0/time_s", "/evaluation/angles/0/error_deg",
        "/evaluation/angles/0/error_deg/1", "/evaluation/angles/0/worst_deg",
        "/evaluation/angles/0/settled_worst_deg"}) {
    json other = before_sums(json::parse(to_json(paper_sized())));
    json& list = other[json::json_pointer(path)];
    list.erase(list.size() - 1);
    EXPECT_THAT(refusal(other.dump()), testing::HasSubstr("length")) << path;
  }
}

TEST(ResultJson, IsRefusedWithCountsThatAreNone) {
  for (const json& value : {json(-1), json(0.5), json("1"), json(), json(1e300)}) {
    json other = before_sums(json::parse(to_json(paper_sized())));
    other["training_windows"] = value;
    EXPECT_NE(refusal(other.dump()), "") << value;
  }
}

TEST(ResultJson, IsRefusedWithAnyOtherValueThanWasWritten) {
  const json whole = json::parse(to_json(paper_sized()));
  for (const char* const path :
       {"/evaluation/errors/0/mse", "/evaluation/speeds/3/rate_dps", "/evaluation/angles/0/error_deg/1/5",
        "/evaluation/gain/histogram/3", "/training_windows", "/simulated", "/job/test", "/instruction_set"}) {
    json other = whole;
    json& value = other[json::json_pointer(path)];
    if (value.is_number_float()) value = value.get<double>() + 1e-9;
    if (value.is_number_unsigned()) value = value.get<std::uint64_t>() + 1;
    if (value.is_boolean()) value = !value.get<bool>();
    if (value.is_string()) value = "another";
    EXPECT_THAT(refusal(other.dump()), testing::HasSubstr("sum: is that of other values")) << path;
  }
  json added = whole;
  added["more"] = 1;
  EXPECT_NE(refusal(added.dump()), "");
  EXPECT_EQ(refusal(whole.dump(2)), "");  // spaces are no values
}

TEST(ResultJson, IsRefusedOutsideTheNetworksSettings) {
  for (const auto& [field, value] : std::vector<std::pair<std::string, int>>{
           {"frames", 7}, {"frames", 1}, {"reduction", 4}, {"epochs", 0}, {"history", -1}}) {
    json other = before_sums(json::parse(to_json(paper_sized())));
    other["job"][field] = value;
    EXPECT_THAT(refusal(other.dump()), testing::HasSubstr("job." + field)) << value;
  }
}

TEST(ResultJson, OfAnotherFormatOrVersionIsRefused) {
  json other = json::parse(to_json(paper_sized()));
  other["version"] = 6;
  EXPECT_THAT(refusal(other.dump()), testing::HasSubstr("version"));
  other["format"] = "something else";
  EXPECT_THAT(refusal(other.dump()), testing::HasSubstr("format"));
}

TEST(ResultJson, OfVersion1HasItsEstimatorsUnderTheNamesOfToday) {
  const JobResult result = paper_sized();
  json before = json::parse(to_json(result));
  before["version"] = 1;
  before["estimators"] = {"thermal", "fusion", "gyro", "gyro_unbiased"};
  const auto keep_four = [](json& of_each) {
    of_each.erase(of_each.begin() + static_cast<int>(place_of(kalman_fusion_name)));
    of_each.erase(of_each.begin() + 4, of_each.end());
  };
  keep_four(before["evaluation"]["errors"]);
  for (json& speed : before["evaluation"]["speeds"]) keep_four(speed["mse"]);
  for (const char* const list : {"error_deg", "drift_deg_per_min", "worst_deg"})
    keep_four(before["evaluation"]["angles"][0][list]);
  const Evaluation back = result_from_json(before.dump(), "").evaluation;
  for (const std::string& name : all_estimators()) {
    if (name == kalman_fusion_name || name == "gyro-kalman" || name == "odometer" ||
        name == "thermal-likelihood")
      continue;
    EXPECT_EQ(back.errors[name].mse, result.evaluation.errors[name].mse) << name;
    EXPECT_EQ(back.speeds[3].mse[name], result.evaluation.speeds[3].mse[name]) << name;
    EXPECT_EQ(back.angles[0].worst_deg[name], result.evaluation.angles[0].worst_deg[name]) << name;
  }
  EXPECT_EQ(back.errors["gyro-kalman"].windows, 0U);
  EXPECT_TRUE(std::isnan(back.errors["gyro-kalman"].mse) && std::isnan(back.speeds[3].mse["gyro-kalman"]));
  EXPECT_TRUE(back.angles[0].error_deg["gyro-kalman"].empty());
}

TEST(ResultJson, OfVersion2LearntTheCommandedSpeedAndSaysNothingOfTheShaft) {
  json before = json::parse(to_json(paper_sized()));
  before["version"] = 2;
  before["job"].erase("label");
  before["evaluation"].erase("shaft_errors");
  const JobResult back = result_from_json(before.dump(), "");
  EXPECT_EQ(back.job.label, Label::commanded);
  EXPECT_EQ(back.evaluation.shaft_errors[fusion_name].windows, 0U);
  EXPECT_EQ(back.evaluation.errors[fusion_name].windows,
            paper_sized().evaluation.errors[fusion_name].windows);
}

TEST(ResultJson, WithALabelThatThereIsNotIsRefused) {
  json other = before_sums(json::parse(to_json(paper_sized())));
  other["job"]["label"] = "rate_shaft";
  EXPECT_THAT(refusal(other.dump()), testing::HasSubstr("job: label"));
}

TEST(ResultJson, LeavesOutEstimatorsThatAreNotKnownHere) {
  const JobResult result = paper_sized();
  json other = before_sums(json::parse(to_json(result)));
  other["estimators"][place_of("gyro-rest")] = "an estimator of tomorrow";
  const Evaluation back = result_from_json(other.dump(), "").evaluation;
  EXPECT_EQ(back.errors["gyro-rest"].windows, 0U);
  EXPECT_EQ(back.errors["gyro-kalman"].mse, result.evaluation.errors["gyro-kalman"].mse);
}

TEST(ResultJson, SurvivesHostileText) {
  const std::string deep(1'000'000, '[');
  for (const std::string& text :
       {std::string(), std::string("null"), std::string("[]"), std::string("{}"), deep, "{\"job\":" + deep,
        std::string("{\"format\":1e999}"), std::string("\xff\xfe{}"), std::string(5'000'000, ' ')})
    EXPECT_NE(refusal(text), "") << text.substr(0, 20);
}

TEST(ResultJson, SurvivesDamagedBytes) {
  const std::string text = to_json(paper_sized());
  std::mt19937_64 random(7);
  for (int i = 0; i < 300; ++i) {
    std::string damaged = text;
    for (int j = 0; j < 3; ++j) damaged[random() % damaged.size()] = static_cast<char>(random());
    refusal(damaged);  // refused, or read as what it says: never a crash
  }
}

}  // namespace
}  // namespace thermorig::study
