// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "boards.h"
#include "quantised_model.h"

namespace thermorig::tests {
namespace {

using embedded::c_source;
using embedded::WeightKind;

class OnACortexM : public ::testing::TestWithParam<std::size_t> {
 protected:
  void SetUp() override {
    if (!has_command("arm-none-eabi-gcc") || !has_command("qemu-system-arm"))
      GTEST_SKIP() << "needs arm-none-eabi-gcc and qemu-system-arm: bash app/setup.sh deep";
  }

  void expect_the_same(const network::Shape& shape, WeightKind kind, float tolerance) {
    const Core& core = cores[GetParam()];
    const model::Model model = random_model(shape, 5);
    const embedded::CSource source = c_source(model, kind, "net");
    const BoardRun run = run_on(board_of(core), source, shape.frames);
    ASSERT_TRUE(run.failure.empty()) << run.failure;
    EXPECT_EQ(run.state_bytes, source.working_bytes);
    EXPECT_LT(run.stack_bytes, 512U);
    EXPECT_GT(run.instructions, 100'000U);
    EXPECT_GT(run.flash_bytes, source.constant_bytes);
    EXPECT_LT(run.flash_bytes, source.constant_bytes + 6000);
    const auto expected = expected_speeds(kind == WeightKind::int8 ? quantised(model) : model);
    EXPECT_LE(largest_difference(run.windows, expected, model.scaling.label_scale_dps), tolerance);
    fmt::print(
        "{:<10} Nf {}, Nr {}, {:<7}: flash {} B, RAM {} B and {} B of stack, {} instructions a window\n",
        core.name, shape.frames, shape.reduction, kind == WeightKind::int8 ? "int8" : "float32",
        run.flash_bytes, run.state_bytes, run.stack_bytes, run.instructions);
  }
};

TEST_P(OnACortexM, SpeedsOfFloatWeightsAreTheEstimators) {
  expect_the_same({.frames = 3, .reduction = 3}, WeightKind::float32, 1e-5F);
}

TEST_P(OnACortexM, SpeedsOfInt8WeightsAreTheEstimators) {
  for (const int reduction : {3, 2, 1})
    expect_the_same({.frames = 3, .reduction = reduction}, WeightKind::int8, 5e-4F);
}

INSTANTIATE_TEST_SUITE_P(Cores, OnACortexM, ::testing::Range<std::size_t>(0, 3));

}  // namespace
}  // namespace thermorig::tests
