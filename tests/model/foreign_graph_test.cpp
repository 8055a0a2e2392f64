// SPDX-License-Identifier: MIT
// The same network as other exporters write it.
#include <gtest/gtest.h>

#include "edited_file.h"

namespace thermorig::model {
namespace {

class ForeignGraph : public testing::Test {
 protected:
  ForeignGraph() { file_.keep_scaling_alone(); }

  /// The file must give the weights of the model that it was made from.
  void expect_same() {
    ASSERT_EQ(refusal_of(file_.bytes()), "");
    const Model read = reread(file_.bytes());
    EXPECT_EQ(read.weights, written_.weights);
    EXPECT_EQ(read.scaling, written_.scaling);
  }

  void transpose(const std::string& name) {
    onnx::TensorProto& tensor = file_.tensor(name);
    const auto values = written_.weights.tensor(name);
    const auto rows = static_cast<std::size_t>(tensor.dims(0)),
               columns = static_cast<std::size_t>(tensor.dims(1));
    std::vector<float> turned(values.size());
    for (std::size_t row = 0; row < rows; ++row)
      for (std::size_t column = 0; column < columns; ++column)
        turned[column * rows + row] = values[row * columns + column];
    tensor.mutable_dims()->SwapElements(0, 1);
    tensor.set_raw_data(turned.data(), turned.size() * sizeof(float));
  }

  void use_matrix_product(const std::string& layer, const std::string& output) {
    onnx::NodeProto& gemm = file_.node(output);
    const std::string input = gemm.input(0);
    gemm.set_op_type("Add");
    gemm.clear_attribute();
    gemm.clear_input();
    gemm.add_input(layer + ".bias");
    gemm.add_input(layer + "_product");
    file_.insert(output, "MatMul", {input, layer + ".weight"}, layer + "_product");
    transpose(layer + ".weight");
  }

  EditedFile file_;
  const Model written_ = sample_model({.frames = 2, .reduction = 3});
};

TEST_F(ForeignGraph, NeedsItsScalingAlone) {
  expect_same();
  const Provenance from = reread(file_.bytes()).provenance;
  EXPECT_EQ(from.producer, "thermorig 0.1.0");
  EXPECT_EQ(from.preset, "");
  EXPECT_EQ(from.epochs, 0);
  EXPECT_TRUE(from.training.empty());
  EXPECT_FALSE(from.simulated);
}

TEST_F(ForeignGraph, MayMultiplyMatricesAndAdd) {
  for (const char* layer : {"speed1", "speed2", "gain1", "gain2"}) use_matrix_product(layer, layer);
  use_matrix_product("speed3", "thermal");
  expect_same();
}

TEST_F(ForeignGraph, MayHaveGemmWithWeightsTurnedRound) {
  file_.set("speed1", "transB", 0);
  transpose("speed1.weight");
  expect_same();
}

TEST_F(ForeignGraph, MayTransposeItsWeightsInTheGraph) {
  file_.set("speed2", "transB", 0);
  onnx::NodeProto& turn = file_.insert("speed2", "Transpose", {"speed2.weight"}, "turned");
  turn.clear_attribute();
  file_.node("speed2").set_input(1, "turned");
  expect_same();
}

TEST_F(ForeignGraph, MayNameItsTensorsAndValuesOtherwise) {
  file_.tensor("speed1.weight").set_name("onnx::MatMul_31");
  file_.node("speed1").set_input(1, "onnx::MatMul_31");
  file_.node("conv1").set_output(0, "value 7");
  file_.node("conv1_relu").set_input(0, "value 7");
  expect_same();
}

TEST_F(ForeignGraph, MayStoreFloatsAsFloats) {
  for (auto& tensor : *file_.graph().mutable_initializer()) {
    std::vector<float> values(tensor.raw_data().size() / sizeof(float));
    std::memcpy(values.data(), tensor.raw_data().data(), tensor.raw_data().size());
    tensor.clear_raw_data();
    tensor.mutable_float_data()->Add(values.begin(), values.end());
  }
  expect_same();
}

TEST_F(ForeignGraph, MayHaveIdentitiesAndConstants) {
  file_.insert("speed1", "Identity", {"speed1.bias"}, "bias");
  file_.node("speed1").set_input(2, "bias");
  onnx::NodeProto& one = file_.insert("conv1", "Constant", {}, "constant one");
  onnx::AttributeProto& value = *one.add_attribute();
  value.set_name("value");
  value.set_type(onnx::AttributeProto::TENSOR);
  *value.mutable_t() = file_.tensor("one");
  file_.node("gyro_gain").set_input(0, "constant one");
  expect_same();
}

TEST_F(ForeignGraph, MayReshapeInsteadOfFlatten) {
  const std::vector<std::vector<std::int64_t>> targets{{0, -1}, {-1, 320}, {0, 320}};
  for (const auto& target : targets) {
    file_ = EditedFile();
    file_.keep_scaling_alone();
    file_.add_integers("target", target);
    file_.node("features").set_op_type("Reshape");
    file_.node("features").add_input("target");
    expect_same();
  }
}

TEST_F(ForeignGraph, MayReshapeToASizeThatItLooksUp) {
  for (const bool axes_are_an_input : {true, false}) {
    const std::string whose = axes_are_an_input ? "conv2_relu" : "frames";
    file_ = EditedFile();
    file_.keep_scaling_alone();
    file_.add_integers("zero", {0});
    file_.tensor("zero").clear_dims();
    file_.add_integers("axes", {0});
    file_.add_integers("rest", {-1});
    file_.insert("features", "Shape", {whose}, "shape");
    file_.insert("features", "Gather", {"shape", "zero"}, "count");
    onnx::NodeProto& widen = file_.insert("features", "Unsqueeze", {"count"}, "counts");
    if (axes_are_an_input) widen.add_input("axes");
    if (!axes_are_an_input) file_.set("counts", "axes", std::vector<std::int64_t>{0});
    file_.insert("features", "Concat", {"counts", "rest"}, "target");
    file_.set("target", "axis", 0);
    file_.node("features").set_op_type("Reshape");
    file_.node("features").add_input("target");
    expect_same();
  }
}

TEST_F(ForeignGraph, MayPoolBeforeTheReLU) {
  file_.node("pool").set_input(0, "conv1");
  file_.node("conv1_relu").set_input(0, "pool");
  file_.graph().mutable_node()->SwapElements(1, 2);
  file_.node("conv2").set_input(0, "conv1_relu");
  expect_same();
}

TEST_F(ForeignGraph, MayWriteTheFusionAsACorrectionOfTheGyro) {
  onnx::NodeProto& difference = file_.node("gyro_gain");
  difference.set_input(0, "thermal");
  difference.set_input(1, "gyro");
  onnx::NodeProto& change = file_.node("gyro_share");
  change.set_input(1, "gain");
  file_.node("fusion").set_input(0, "gyro");
  expect_same();
}

TEST_F(ForeignGraph, MayNameFactorsAndSummandsInAnyOrder) {
  for (const char* name : {"thermal_share", "gyro_share", "fusion"})
    file_.node(name).mutable_input()->SwapElements(0, 1);
  expect_same();
}

TEST_F(ForeignGraph, MayHaveTheFusionAsItsOnlyOutput) {
  file_.graph().mutable_output()->DeleteSubrange(1, 2);
  expect_same();
}

TEST_F(ForeignGraph, MayListItsWeightsAmongItsInputs) {
  for (const auto& tensor : file_.graph().initializer()) file_.graph().add_input()->set_name(tensor.name());
  file_.file().set_ir_version(3);
  file_.file().mutable_opset_import(0)->set_version(9);
  expect_same();
}

TEST_F(ForeignGraph, MayLeaveOutWhatIsUsualAnyway) {
  file_.node("conv2").clear_attribute();
  file_.set("conv2", "pads", {2, 2, 2, 2});
  file_.node("pool").clear_attribute();
  file_.set("pool", "kernel_shape", {2, 2});
  file_.set("pool", "strides", {2, 2});
  file_.set("pool", "ceil_mode", 0);
  expect_same();
}

TEST_F(ForeignGraph, WithoutPaddingHasNone) {
  const network::Shape shape{.frames = 2, .padding1 = 0, .padding2 = 0};
  file_ = EditedFile(sample_model(shape));
  file_.keep_scaling_alone();
  file_.node("conv1").clear_attribute();
  ASSERT_EQ(refusal_of(file_.bytes()), "");
  EXPECT_EQ(reread(file_.bytes()).weights.shape, shape);
}

}  // namespace
}  // namespace thermorig::model
