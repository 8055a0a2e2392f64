// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "boards.h"
#include "quantised_model.h"
#include "thermorig/core/error.h"

namespace thermorig::tests {
namespace {

using embedded::c_source;
using embedded::WeightKind;
using ::testing::HasSubstr;
using ::testing::Not;

const std::vector<network::Shape> shapes{
    {.frames = 3, .reduction = 3},
    {.frames = 2, .reduction = 3, .fusion = false},
    {.frames = 6, .reduction = 3, .padding1 = 0, .crop_left = 1},
    {.frames = 4, .reduction = 2, .padding1 = 1, .padding2 = 2},
    {.frames = 3, .reduction = 2, .padding1 = 2, .padding2 = 1},
    {.frames = 3, .reduction = 1, .fusion = false, .padding1 = 0, .padding2 = 0},
};
constexpr float scale_dps = 200.0F;
constexpr float whole_numbers_tolerance = 5e-4F;  // 0.1 deg/s: frames in 1/256 degree, activations in 16 bits
constexpr float float_tolerance = 1e-5F;

std::string host(const std::string& options = "") {
  return "cc" + options + strict_c99;
}

void expect_windows(const BoardRun& run, const model::Model& model, float tolerance) {
  ASSERT_TRUE(run.failure.empty()) << run.failure;
  const auto expected = expected_speeds(model);
  EXPECT_LE(largest_difference(run.windows, expected, scale_dps), tolerance);
  EXPECT_LE(largest_difference(run.first_again, {expected.front()}, scale_dps), tolerance);
}

class ExportedC : public ::testing::TestWithParam<std::size_t> {
 protected:
  const network::Shape& shape() const { return shapes[GetParam()]; }
  const model::Model model_ = random_model(shape(), GetParam() + 1);
};

TEST_P(ExportedC, SaysWhatTheEstimatorSays) {
  const embedded::CSource source = c_source(model_, WeightKind::float32, "net");
  const BoardRun run = run_on({host()}, source, shape().frames);
  expect_windows(run, model_, float_tolerance);
  EXPECT_EQ(run.state_bytes, source.working_bytes);
}

TEST_P(ExportedC, WithInt8WeightsSaysWhatTheEstimatorOfTheseSays) {
  const BoardRun run =
      run_on({host(" -DNET_INTEGER=0")}, c_source(model_, WeightKind::int8, "net"), shape().frames);
  expect_windows(run, quantised(model_), float_tolerance);
}

TEST_P(ExportedC, InWholeNumbersSaysNearlyTheSame) {
  const embedded::CSource source = c_source(model_, WeightKind::int8, "net");
  const BoardRun run = run_on({host()}, source, shape().frames);
  expect_windows(run, quantised(model_), whole_numbers_tolerance);
  EXPECT_EQ(run.state_bytes, source.working_bytes);
}

TEST_P(ExportedC, ScalesEachWindowByItselfAsTheProgramDoes) {
  model::Model model = model_;
  model.scaling = network::scaling_by_window(scale_dps);
  const embedded::CSource floats = c_source(model, WeightKind::float32, "net");
  const BoardRun run = run_on({host()}, floats, shape().frames);
  expect_windows(run, model, float_tolerance);
  EXPECT_EQ(run.state_bytes, floats.working_bytes);
  const embedded::CSource whole = c_source(model, WeightKind::int8, "net");
  const BoardRun in_whole_numbers = run_on({host()}, whole, shape().frames);
  expect_windows(in_whole_numbers, quantised(model), whole_numbers_tolerance);
  EXPECT_EQ(in_whole_numbers.state_bytes, whole.working_bytes);
}

INSTANTIATE_TEST_SUITE_P(OfEveryShape, ExportedC, ::testing::Range<std::size_t>(0, 6));

/// A compiler, what it is to take the C for, and the weights.
class CompiledC : public ::testing::TestWithParam<std::tuple<const char*, WeightKind>> {};

TEST_P(CompiledC, SaysTheSame) {
  const auto [compiler, kind] = GetParam();
  const std::string command(compiler);
  if (!has_command(command.substr(0, command.find(' ')))) GTEST_SKIP() << "there is no " << command;
  const model::Model model = random_model(shapes[0], 3);
  const BoardRun run = run_on({command}, c_source(model, kind, "net"), shapes[0].frames);
  if (kind == WeightKind::int8)
    expect_windows(run, quantised(model), whole_numbers_tolerance);
  else
    expect_windows(run, model, float_tolerance);
}

INSTANTIATE_TEST_SUITE_P(
    Compilers, CompiledC,
    ::testing::Combine(
        ::testing::Values(
            "c++ -x c++ -std=c++11 -Wall -Wextra -Wconversion -Wshadow -Werror -pedantic",
            "clang-14 -std=c99 -O2 -Wall -Wextra -Wconversion -Wshadow -Werror -pedantic",
            "cc -std=c99 -O1 -fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all"),
        ::testing::Values(WeightKind::float32, WeightKind::int8)));

TEST(CSource, SumsOfWholeNumbersStayWithinTheirType) {
  model::Model model = random_model({.frames = 6, .reduction = 1}, 1);
  for (float& weight : model.weights.values) weight = 1.0F;
  model.scaling.temp_mean_c = -400.0F;  // every pixel is as far above it as 16 bits go
  const BoardRun run = run_on({"cc -std=c99 -O1 -fsanitize=undefined -fno-sanitize-recover=all"},
                              c_source(model, WeightKind::int8, "net"), 6);
  EXPECT_TRUE(run.failure.empty()) << run.failure;
  EXPECT_EQ(run.windows.size(), 4U);
}

std::string text_of(const embedded::CSource& source, const std::string& name) {
  for (const embedded::SourceFile& file : source.files)
    if (file.name == name) return file.text;
  ADD_FAILURE() << "no file " << name;
  return "";
}

/// The numbers between the braces of an array.
std::vector<float> numbers_of(const std::string& text, const std::string& array) {
  std::vector<float> numbers;
  const char* at = text.c_str() + text.find("*/", text.find(" " + array + "["));
  for (at += 2; *at != '}' && *at != '\0';) {
    char* end = nullptr;
    const float number = std::strtof(at, &end);
    if (end == at) {
      ++at;  // a comma, a space, the f of a float
    } else {
      numbers.push_back(number);
      at = end;
    }
  }
  return numbers;
}

TEST(CSource, FloatWeightsReadBackBitForBit) {
  model::Model model = random_model(shapes[0], 4);
  model.weights.values[0] = 1.0F;
  model.weights.values[1] = -0.0F;
  model.weights.values[2] = 1e-42F;  // below the smallest normal number
  model.weights.values[3] = 3.4028235e38F;
  const std::string text = text_of(c_source(model, WeightKind::float32, "net"), "net_weights.h");
  for (const std::string name : {"conv1", "conv2", "speed1", "speed2", "speed3", "gain1", "gain2"}) {
    const auto expected = model.weights.tensor(name + ".weight");
    EXPECT_EQ(numbers_of(text, name + "_weights"), std::vector<float>(expected.begin(), expected.end()))
        << name;
  }
  EXPECT_THAT(text, HasSubstr(" 1.0f, -0.0f, "));
}

TEST(CSource, HasTheNameThatItWasGiven) {
  const auto source = c_source(random_model(shapes[0], 1), WeightKind::int8, "Garden2");
  EXPECT_THAT(text_of(source, "Garden2.h"), HasSubstr("#define GARDEN2_FRAMES 3"));
  EXPECT_THAT(text_of(source, "Garden2.h"), HasSubstr("int Garden2_push(Garden2_state* state"));
  for (const embedded::SourceFile& file : source.files) {
    EXPECT_THAT(file.text, Not(HasSubstr("thermorig_network"))) << file.name;
    EXPECT_THAT(file.text, Not(HasSubstr("THERMORIG_NETWORK"))) << file.name;
  }
}

TEST(CSource, RefusesNamesThatAreNone) {
  const model::Model model = random_model(shapes[0], 1);
  for (const std::string name :
       {"", "2nd", "_net", "my net", "net-1", "../net", "n\xC3\xA4t", "math", "stdint"}) {
    try {
      c_source(model, WeightKind::int8, name);
      ADD_FAILURE() << "took '" << name << "'";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_usage);
    }
  }
  EXPECT_THROW(c_source(model, WeightKind::int8, std::string(49, 'n')), Error);
}

TEST(CSource, SaysThatItsDataWereSimulatedAndWhatTheyWere) {
  model::Model model = random_model(shapes[0], 1);
  model.provenance.training = {{"garden_acq-01", "0123abcd"}};
  model.provenance.data_licence = "CC-BY-4.0";
  const auto source = c_source(model, WeightKind::int8, "net");
  for (const embedded::SourceFile& file : source.files) {
    EXPECT_THAT(file.text, HasSubstr("SIMULATED")) << file.name;
    EXPECT_THAT(file.text, HasSubstr("CC-BY-4.0")) << file.name;
  }
  EXPECT_THAT(text_of(source, "net_weights.h"), HasSubstr("garden_acq-01 0123abcd"));
  model.provenance.simulated = false;
  for (const embedded::SourceFile& file : c_source(model, WeightKind::int8, "net").files)
    EXPECT_THAT(file.text, Not(HasSubstr("SIMULATED"))) << file.name;
}

TEST(CSource, TextOfAModelFileCannotLeaveItsComment) {
  model::Model model = random_model(shapes[1], 1);
  const std::string hostile = "*/ int broken; /* \n#error line\r\\ \?\?/ @frames@ thermorig_network " +
                              std::string(1, '\0') + "*" + std::string(5000, 'x');
  model.provenance.data_licence = model.provenance.producer = model.provenance.preset = hostile;
  model.provenance.training = {{hostile, hostile}};
  model.provenance.held_out = {{"/", "*"}, {"*", "/"}};
  const auto source = c_source(model, WeightKind::int8, "net");
  const BoardRun run = run_on({host()}, source, 2);
  EXPECT_TRUE(run.failure.empty()) << run.failure;
  for (const embedded::SourceFile& file : source.files) {
    EXPECT_THAT(file.text, Not(HasSubstr("*/ int"))) << file.name;
    EXPECT_THAT(file.text, Not(HasSubstr("\n#error line"))) << file.name;
  }
}

TEST(CSource, SizesCountEveryConstant) {
  const model::Model model = random_model({.frames = 3, .reduction = 3}, 1);
  EXPECT_EQ(c_source(model, WeightKind::float32, "net").constant_bytes, 4 * (89'794U + 3));
  // 9,600 weights of the second layer, 200 of the outputs and 344 biases stay; a scale a row of the rest.
  const std::size_t kept = 9'600 + 200 + 344, rows = 6 + 16 + 120 + 120;
  EXPECT_EQ(c_source(model, WeightKind::int8, "net").constant_bytes, 89'794 - kept + 4 * (kept + rows + 3));
}

}  // namespace
}  // namespace thermorig::tests
