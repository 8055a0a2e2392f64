// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "edited_file.h"

namespace thermorig::model {
namespace {

bool same(const std::vector<Provenance::Data>& a, const std::vector<Provenance::Data>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const auto& x, const auto& y) { return x.name == y.name && x.hash == y.hash; });
}

void expect_same(const Provenance& read, const Provenance& written) {
  EXPECT_EQ(read.producer, written.producer);
  EXPECT_EQ(read.preset, written.preset);
  EXPECT_EQ(read.label, written.label);
  EXPECT_EQ(read.seed, written.seed);
  EXPECT_EQ(read.epochs, written.epochs);
  EXPECT_EQ(read.epoch_kept, written.epoch_kept);
  EXPECT_TRUE(same(read.training, written.training));
  EXPECT_TRUE(same(read.held_out, written.held_out));
  EXPECT_EQ(read.simulated, written.simulated);
  EXPECT_EQ(read.data_licence, written.data_licence);
}

void expect_same_bits(const std::vector<float>& read, const std::vector<float>& written) {
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i)
    ASSERT_EQ(std::bit_cast<std::uint32_t>(read[i]), std::bit_cast<std::uint32_t>(written[i])) << i;
}

TEST(ModelFile, ComesBackBitForBitForEveryShape) {
  for (const network::Shape& shape : all_shapes()) {
    const Model written = sample_model(shape);
    const Model read = reread(to_onnx(written));
    EXPECT_EQ(read.weights.shape, shape);
    expect_same_bits(read.weights.values, written.weights.values);
    EXPECT_EQ(read.scaling, written.scaling);
    expect_same(read.provenance, written.provenance);
  }
}

TEST(ModelFile, SaysNothingOfALabelThatItsOriginDidNotState) {
  Model written = small_model();
  written.provenance.label.reset();
  EXPECT_FALSE(reread(to_onnx(written)).provenance.label);
}

TEST(ModelFile, OfATimeWithoutAChoiceLearntTheCommandedSpeed) {
  EditedFile file;
  file.remove_key("label");
  EXPECT_EQ(reread(file.bytes()).provenance.label, Label::commanded);
  file.keep_scaling_alone();  // a foreign one may have learnt anything
  EXPECT_FALSE(reread(file.bytes()).provenance.label);
}

TEST(ModelFile, KeepsPaddingsAndTheCroppedColumn) {
  for (const int padding1 : {0, 1, 2}) {
    const network::Shape shape{.reduction = 3, .padding1 = padding1, .padding2 = 2, .crop_left = padding1};
    EXPECT_EQ(reread(to_onnx(sample_model(shape))).weights.shape, shape);
  }
}

TEST(ModelFile, KeepsWeightsThatAreHardToPrint) {
  Model written = small_model();
  using limits = std::numeric_limits<float>;
  const std::vector<float> hard{-0.0F, limits::denorm_min(), limits::min(), limits::max(), limits::lowest()};
  std::copy(hard.begin(), hard.end(), written.weights.values.begin());
  expect_same_bits(reread(to_onnx(written)).weights.values, written.weights.values);
}

TEST(ModelFile, IsTheSameForTheSameModel) {
  EXPECT_EQ(to_onnx(small_model()), to_onnx(small_model()));
}

TEST(ModelFile, WithAFixedBatchIsTheSameModel) {
  const Model written = sample_model({.reduction = 3});
  const std::string file = to_onnx(written, 1);
  EXPECT_NE(file, to_onnx(written));
  EXPECT_EQ(reread(file).weights, written.weights);
}

TEST(ModelFile, TakesNamesThatAreNoPlainText) {
  Model written = small_model();
  written.provenance.training = {{"a\x1b[31mred\nname\xff", "hash"}, {"", ""}};
  written.provenance.data_licence = std::string(5000, 'x');
  const Provenance read = reread(to_onnx(written)).provenance;
  ASSERT_EQ(read.training.size(), 2U);
  EXPECT_EQ(read.training[0].name, "a?[31mred?name?");
  EXPECT_EQ(read.training[1].name, "");
  EXPECT_EQ(read.data_licence, std::string(1000, 'x'));
}

TEST(ModelFile, TellsOfThousandsOfAcquisitions) {
  Model written = small_model();
  written.provenance.training.assign(10'000, {"garden_acq-01", std::string(64, 'a')});
  EXPECT_EQ(reread(to_onnx(written)).provenance.training.size(), 10'000U);
}

}  // namespace
}  // namespace thermorig::model
