// SPDX-License-Identifier: MIT
// Outputs, gradients and loss paths beside what PyTorch says (golden/make_golden.py).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <string_view>

#include "../interop/seeded_values.h"
#include "reference_network.h"
#include "thermorig/network/estimator.h"
#include "thermorig/network/trainer.h"

namespace thermorig::network {
namespace {

constexpr std::uint64_t seed = 100, projection_seed = 999;
constexpr double agreement = 1e-4;  // of the largest value of a tensor or of a loss path

struct Gradient {
  std::string name;
  double largest = 0.0, projection = 0.0;
  std::vector<std::pair<std::size_t, double>> chosen;
};

struct Golden {
  std::string name;
  Shape shape;
  TrainerConfig config;
  std::size_t samples = 0;
  bool mirrored = false;
  std::vector<double> outputs;  // fusion, thermal, gain of each sample
  std::vector<Gradient> gradients;
  std::vector<double> losses;

  std::unique_ptr<interop::SeededBatch> batch(std::uint64_t number) const {
    auto batch = std::make_unique<interop::SeededBatch>(shape, seed, number, samples);
    if (mirrored) batch->mirror_every_second();
    return batch;
  }
};

Golden read_case(std::istringstream& line) {
  Golden golden;
  double auxiliary = 0.0;
  std::string key;
  line >> golden.name >> key >> golden.shape.frames >> key >> golden.shape.reduction >> key >>
      golden.shape.fusion >> key >> golden.shape.padding1 >> key >> golden.shape.padding2 >> key >>
      auxiliary >> key >> golden.samples >> key >> golden.mirrored;
  golden.config.loss.auxiliary_thermal = static_cast<float>(auxiliary);
  return golden;
}

std::vector<double> read_values(std::istringstream& line, std::size_t count) {
  std::vector<double> values(count);
  for (double& value : values) line >> value;
  return values;
}

Gradient read_gradient(std::istringstream& line) {
  Gradient gradient;
  std::size_t count = 0;
  line >> gradient.name >> gradient.largest >> gradient.projection >> count;
  gradient.chosen.resize(count);
  for (auto& [index, value] : gradient.chosen) line >> index >> value;
  return gradient;
}

std::vector<Golden> read_golden() {
  std::ifstream file(THERMORIG_SOURCE_DIR "/tests/network/golden/golden.txt");
  std::vector<Golden> cases;
  for (std::string text, kind; std::getline(file, text);) {
    std::istringstream line(text);
    std::size_t count = 0;
    line >> kind;
    if (kind == "case") cases.push_back(read_case(line));
    if (kind == "gradient") cases.back().gradients.push_back(read_gradient(line));
    if (kind == "outputs" && line >> count) cases.back().outputs = read_values(line, 3 * count);
    if (kind == "losses" && line >> count) cases.back().losses = read_values(line, count);
    EXPECT_FALSE(line.fail()) << text;
  }
  return cases;
}

/// `gradient`: of one tensor, float or double.
template <typename Values>
void expect_gradient(const Golden& golden, const Gradient& expected, const Values& gradient, double limit) {
  for (const auto& [index, value] : expected.chosen) {
    ASSERT_LT(index, gradient.size());
    EXPECT_NEAR(gradient[index], value, limit * expected.largest)
        << golden.name << ' ' << expected.name << '[' << index << ']';
  }
  const auto directions = interop::seeded_values(projection_seed, gradient.size());
  double projection = 0.0;
  for (std::size_t i = 0; i < gradient.size(); ++i)
    projection += static_cast<double>(gradient[i]) * static_cast<double>(directions[i]);
  const double root = std::sqrt(static_cast<double>(gradient.size()));
  EXPECT_NEAR(projection, expected.projection, limit * expected.largest * root)
      << golden.name << ' ' << expected.name;
}

template <typename Value>
void expect_gradients(const Golden& golden, std::span<const Value> gradients, double limit) {
  const auto tensors = tensors_of(golden.shape);
  ASSERT_EQ(golden.gradients.size(), tensors.size());
  for (std::size_t t = 0; t < tensors.size(); ++t) {
    ASSERT_EQ(golden.gradients[t].name, tensors[t].name);
    expect_gradient(golden, golden.gradients[t], gradients.subspan(tensors[t].offset, tensors[t].size),
                    limit);
  }
}

class GoldenVectors : public testing::TestWithParam<InstructionSet> {};

TEST(GoldenFile, CoversBothModesTheAuxiliaryLossTheMirrorAndShortBatches) {
  const auto cases = read_golden();
  EXPECT_EQ(cases.size(), 7U);
  for (const Golden& golden : cases) {
    EXPECT_EQ(golden.outputs.size(), 3 * golden.samples) << golden.name;
    EXPECT_GE(golden.losses.size(), 20U) << golden.name;
  }
}

// Both compute in double precision, so that they agree far more closely. It is slow: the first steps only.
TEST(ReferenceNetwork, IsTrainedAsInPyTorch) {
  for (const Golden& golden : read_golden()) {
    const LossConfig& loss = golden.config.loss;
    ReferenceNetwork network(interop::seeded_weights(golden.shape, seed));
    const auto first = network.gradients(golden.batch(0)->batch(), loss);
    expect_gradients(golden, std::span<const double>(first.values), 1e-7);
    for (std::size_t step = 0; step < 3; ++step)
      EXPECT_NEAR(network.step(golden.batch(step)->batch(), loss, {}).loss, golden.losses[step], 1e-6)
          << golden.name << " step " << step;
  }
}

TEST_P(GoldenVectors, OutputsOfBothEstimatorsAreThoseOfPyTorch) {
  for (const Golden& golden : read_golden()) {
    if (golden.mirrored) continue;  // the single estimator knows no mirror
    const Weights weights = interop::seeded_weights(golden.shape, seed);
    const auto owner = golden.batch(0);
    const Batch batch = owner->batch();
    std::vector<Output> outputs(golden.samples);
    BatchEstimator(weights, GetParam()).estimate(batch, outputs);
    Estimator single(weights, Precision::fp32, GetParam());
    for (std::size_t i = 0; i < golden.samples; ++i) {
      const float gyro = golden.shape.fusion ? batch.gyro[i] : 0.0F;
      const Output one = single.estimate({batch.frames[i], golden.shape.inputs()}, gyro);
      for (const Output& output : {outputs[i], one}) {
        EXPECT_NEAR(output.fusion, golden.outputs[3 * i], 1e-5) << golden.name;
        EXPECT_NEAR(output.thermal, golden.outputs[3 * i + 1], 1e-5) << golden.name;
        EXPECT_NEAR(output.gain, golden.outputs[3 * i + 2], 1e-5) << golden.name;
      }
    }
  }
}

TEST_P(GoldenVectors, GradientsAreThoseOfPyTorch) {
  for (const Golden& golden : read_golden()) {
    TrainerConfig config = golden.config;
    config.set = GetParam();
    CallingThread workers;
    Trainer trainer(interop::seeded_weights(golden.shape, seed), config, workers);
    expect_gradients(golden, std::span<const float>(trainer.gradients(golden.batch(0)->batch())), agreement);
  }
}

TEST_P(GoldenVectors, TwentyFourStepsOfAdamLoseAsInPyTorch) {
  for (const Golden& golden : read_golden()) {
    TrainerConfig config = golden.config;
    config.set = GetParam();
    CallingThread workers;
    Trainer trainer(interop::seeded_weights(golden.shape, seed), config, workers);
    const double largest = *std::max_element(golden.losses.begin(), golden.losses.end());
    for (std::size_t step = 0; step < golden.losses.size(); ++step)
      EXPECT_NEAR(trainer.step(golden.batch(step)->batch()).loss, golden.losses[step], agreement * largest)
          << golden.name << " step " << step;
  }
}

std::string test_name(const testing::TestParamInfo<InstructionSet>& info) {
  std::string name(name_of(info.param));
  std::erase(name, '-');
  return name;
}

INSTANTIATE_TEST_SUITE_P(EveryInstructionSet, GoldenVectors, testing::ValuesIn(instruction_sets()),
                         test_name);

}  // namespace
}  // namespace thermorig::network
