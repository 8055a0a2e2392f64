// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "boards.h"
#include "thermorig/core/error.h"

namespace thermorig::tests {
namespace {

using embedded::c_source;
using embedded::quantised;
using embedded::WeightKind;

const std::vector<network::Shape> shapes{
    {.frames = 3, .reduction = 3},
    {.frames = 2, .reduction = 3, .fusion = false},
    {.frames = 6, .reduction = 3, .padding1 = 0, .crop_left = 1},
    {.frames = 4, .reduction = 2, .padding1 = 1, .padding2 = 2},
    {.frames = 3, .reduction = 2, .padding1 = 2, .padding2 = 1, .crop_left = 0},
    {.frames = 3, .reduction = 1, .fusion = false, .padding1 = 0, .padding2 = 0},
};

class ExportedC : public ::testing::TestWithParam<std::size_t> {};

TEST_P(ExportedC, SaysWhatTheEstimatorSays) {
  const model::Model model = random_model(shapes[GetParam()], GetParam() + 1);
  const embedded::CSource source = c_source(model, WeightKind::float32, "net");
  const BoardRun run = run_on({std::string("cc") + strict_c99}, source);
  ASSERT_TRUE(run.failure.empty()) << run.failure;
  EXPECT_EQ(run.state_bytes, source.working_bytes);
  EXPECT_LE(largest_difference(run.windows, expected_speeds(model), 200.0F), 1e-5F);
}

TEST_P(ExportedC, WithInt8WeightsSaysWhatTheEstimatorOfTheseSays) {
  const model::Model model = random_model(shapes[GetParam()], GetParam() + 1);
  const embedded::CSource source = c_source(model, WeightKind::int8, "net");
  const BoardRun run = run_on({std::string("cc -DNET_INTEGER=0") + strict_c99}, source);
  ASSERT_TRUE(run.failure.empty()) << run.failure;
  EXPECT_LE(largest_difference(run.windows, expected_speeds(quantised(model)), 200.0F), 1e-5F);
}

TEST_P(ExportedC, InWholeNumbersSaysNearlyTheSame) {
  const model::Model model = random_model(shapes[GetParam()], GetParam() + 1);
  const embedded::CSource source = c_source(model, WeightKind::int8, "net");
  const BoardRun run = run_on({std::string("cc") + strict_c99}, source);
  ASSERT_TRUE(run.failure.empty()) << run.failure;
  EXPECT_EQ(run.state_bytes, source.working_bytes);
  // Frames are kept in hundredths of a degree and activations in 16 bits: 0.1 deg/s.
  EXPECT_LE(largest_difference(run.windows, expected_speeds(quantised(model)), 200.0F), 5e-4F);
}

INSTANTIATE_TEST_SUITE_P(OfEveryShape, ExportedC, ::testing::Range<std::size_t>(0, 6));

}  // namespace
}  // namespace thermorig::tests
