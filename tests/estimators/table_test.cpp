// SPDX-License-Identifier: MIT
#include "thermorig/estimators/table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "hand_made.h"
#include "thermorig/core/error.h"

namespace thermorig::estimators {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Error refusal_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << "nothing was refused";
  return Error(ExitCode::ok, "", "", "");
}

TEST(TheTableOfEstimators, HasANameOfItsOwnForEachAndForEachOfItsValues) {
  std::set<std::string_view> names;
  for (const Entry& one : all_entries()) {
    EXPECT_TRUE(names.insert(one.name).second) << one.name;
    EXPECT_FALSE(one.title.empty()) << one.name;
    EXPECT_LE(one.values.size(), most_estimate_values) << one.name;
    EXPECT_EQ(std::set(one.values.begin(), one.values.end()).size(), one.values.size()) << one.name;
    EXPECT_EQ(&entry(one.name), &one);
  }
}

TEST(TheTableOfEstimators, RefusesANameThatItDoesNotHaveAndNamesTheNearest) {
  const Error error = refusal_of([] { entry("gyro-kalmann"); });
  EXPECT_EQ(error.code(), ExitCode::bad_usage);
  EXPECT_EQ(error.what_happened(), "the estimator \"gyro-kalmann\" is not known");
  EXPECT_THAT(error.advice(), HasSubstr("did you mean \"gyro-kalman\"?"));
  for (const std::string& name : names()) EXPECT_THAT(error.advice(), HasSubstr(name));
}

TEST(TheTableOfEstimators, TellsWhichCanRunWithAModel) {
  EXPECT_THAT(names_for(std::nullopt),
              ElementsAre("gyro", "gyro-rest", "gyro-kalman", "odometer", "thermal-likelihood"));
  EXPECT_THAT(
      names_for(untrained_model({.fusion = false})),
      ElementsAre("gyro", "gyro-rest", "gyro-kalman", "odometer", "thermal-likelihood", "cnn-thermal"));
  EXPECT_THAT(names_for(untrained_model()), ElementsAre("gyro", "gyro-rest", "gyro-kalman", "odometer",
                                                        "thermal-likelihood", "cnn-thermal", "cnn-fusion"));
  EXPECT_EQ(names_for(untrained_model_with_sigma()), names());
}

TEST(ABank, WithoutNamesRunsAllThatCan) {
  const Bank bank({}, untrained_model({.frames = 2, .fusion = false}), {});
  EXPECT_EQ(bank.entries().size(), names().size() - 2);
  EXPECT_EQ(bank.frames(), 2);
}

TEST(ABank, RunsThoseThatAreNamedInTheirOrder) {
  const std::vector<std::string> chosen{"gyro-rest", "gyro"};
  const Bank bank(chosen, std::nullopt, {});
  ASSERT_EQ(bank.entries().size(), 2U);
  EXPECT_EQ(bank.entries()[0]->name, "gyro-rest");
  EXPECT_EQ(bank.entries()[1]->name, "gyro");
  EXPECT_EQ(bank.frames(), 1);
}

TEST(ABank, RefusesTheNetworksEstimatorsWithoutANetwork) {
  for (const std::string name : {"cnn-thermal", "cnn-fusion"}) {
    const Error error = refusal_of([&] { bank_of(name, {}); });
    EXPECT_EQ(error.code(), ExitCode::bad_usage);
    EXPECT_EQ(error.what_happened(), "the estimator \"" + name + "\" needs a network");
    EXPECT_EQ(error.advice(), "--model FILE");
  }
}

TEST(ABank, RefusesFusionOfANetworkThatHasNone) {
  const Error error = refusal_of([] { bank_of("cnn-fusion", {}, untrained_model({.fusion = false})); });
  EXPECT_EQ(error.code(), ExitCode::bad_usage);
  EXPECT_THAT(error.what_happened(), HasSubstr("needs a network with fusion"));
}

TEST(ABank, RefusesANameThatThereIsNot) {
  EXPECT_THROW(bank_of("gyroscope", {}), Error);
}

}  // namespace
}  // namespace thermorig::estimators
