// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "board_room.h"
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

/// With a floating-point unit: what it is made for.
class OdometerOnACortexM : public OnACortexM {};

/// In a room, until it tracks, with a gyro whose noise it hears. Seven minutes:
/// docs/export.md.
TEST_P(OdometerOnACortexM, SaysTheSameAsOnThisMachine) {
  const Core& core = cores[GetParam()];
  const RigProfile rig;
  auto all = seen_in(turning_room(45.0));
  shake(all);
  const std::string recording = recording_of(all, rig);
  const board_odometer::OdometerSource source = board_odometer::odometer_source(rig, "odo");
  const OdometerRun host = run_odometer_on({.compiler = "cc" + std::string(strict_c99)}, source, recording);
  const OdometerRun board = run_odometer_on(board_of(core), source, recording);
  ASSERT_TRUE(host.failure.empty()) << host.failure;
  ASSERT_TRUE(board.failure.empty()) << board.failure;
  ASSERT_EQ(board.frames.size(), host.frames.size());
  ASSERT_GT(board.frames.size(), 200U);
  std::uint32_t instructions = 0, stack_bytes = 0;
  for (std::size_t i = 0; i < board.frames.size(); ++i) {
    const thermorig_odometer_output &here = host.frames[i].output, &there = board.frames[i].output;
    ASSERT_EQ(there.state, here.state) << i;
    ASSERT_EQ(there.turns, here.turns) << i;
    ASSERT_NEAR(there.heading_deg, here.heading_deg, 0.01F) << i;
    instructions = std::max(instructions, board.frames[i].instructions);
    stack_bytes = std::max(stack_bytes, board.frames[i].stack_bytes);
  }
  EXPECT_EQ(board.state_bytes, source.state_bytes);
  EXPECT_LE(stack_bytes, source.stack_bytes);
  EXPECT_LE(board.state_bytes + source.stack_bytes, 40'000U);
  fmt::print("odometer on a {}: flash {} B, RAM {} B and {} B of stack, at most {} instructions a frame\n",
             core.name, board.flash_bytes, board.state_bytes, stack_bytes, instructions);
  EXPECT_EQ(board.frames.back().output.state, THERMORIG_ODOMETER_TRACKING);
  EXPECT_LT(instructions, 10'500'000U);
}

INSTANTIATE_TEST_SUITE_P(Cores, OdometerOnACortexM, ::testing::Values(0));
INSTANTIATE_TEST_SUITE_P(Cores, OnACortexM, ::testing::Range<std::size_t>(0, 3));

}  // namespace
}  // namespace thermorig::tests
