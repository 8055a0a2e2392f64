// SPDX-License-Identifier: MIT
// Networks with the names of ours that compute something else must not be taken for it.
#include <gmock/gmock.h>

#include <functional>

#include "edited_file.h"

namespace thermorig::model {
namespace {

struct Change {
  const char* name;
  std::function<void(EditedFile&)> apply;
};

void PrintTo(const Change& change, std::ostream* out) {
  *out << change.name;
}

class OtherGraph : public testing::TestWithParam<Change> {};

TEST_P(OtherGraph, IsRefused) {
  EditedFile file;
  ASSERT_EQ(refusal_of(file.bytes()), "");
  GetParam().apply(file);
  EXPECT_THAT(refusal_of(file.bytes()), testing::HasSubstr("graph"));
}

void replace(EditedFile& file, const char* output, const char* operation) {
  file.node(output).set_op_type(operation);
}

void rewire(EditedFile& file, const char* output, int input, const char* to) {
  file.node(output).set_input(input, to);
}

void add_beta(EditedFile& file, float beta) {
  onnx::AttributeProto& attribute = file.attribute("speed2", "beta");
  attribute.set_type(onnx::AttributeProto::FLOAT);
  attribute.set_f(beta);
}

void add_text(EditedFile& file, const char* output, const char* name, const char* text) {
  onnx::AttributeProto& attribute = file.attribute(output, name);
  attribute.set_type(onnx::AttributeProto::STRING);
  attribute.set_s(text);
}

void reshape_to(EditedFile& file, const std::vector<std::int64_t>& target) {
  file.add_integers("target", target);
  replace(file, "features", "Reshape");
  file.node("features").add_input("target");
}

const Change changes[] = {
    {"StrideTwo",
     [](EditedFile& f) {
       f.set("conv1", "strides", {2, 2});
     }},
    {"Dilated",
     [](EditedFile& f) {
       f.set("conv2", "dilations", {2, 2});
     }},
    {"Grouped", [](EditedFile& f) { f.set("conv2", "group", 2); }},
    {"KernelOfThree",
     [](EditedFile& f) {
       f.set("conv1", "kernel_shape", {3, 3});
     }},
    {"AutomaticPadding", [](EditedFile& f) { add_text(f, "conv1", "auto_pad", "SAME_UPPER"); }},
    {"UnknownAttribute", [](EditedFile& f) { f.set("conv1", "surprise", 1); }},
    {"AttributeTwice",
     [](EditedFile& f) { *f.node("conv1").add_attribute() = f.node("conv1").attribute(0); }},
    {"AttributeOfAnotherType", [](EditedFile& f) { f.set("conv1", "strides", 1); }},
    {"PooledByThree",
     [](EditedFile& f) {
       f.set("pool", "kernel_shape", {3, 3});
     }},
    {"PooledWithStrideOne",
     [](EditedFile& f) {
       f.set("pool", "strides", {1, 1});
     }},
    {"PooledUpwards", [](EditedFile& f) { f.set("pool", "ceil_mode", 1); }},
    {"PooledWithPadding",
     [](EditedFile& f) {
       f.set("pool", "pads", {1, 1, 1, 1});
     }},
    {"PooledByMean", [](EditedFile& f) { replace(f, "pool", "AveragePool"); }},
    {"NotPooled", [](EditedFile& f) { f.bypass("pool"); }},
    {"NoReLUAfterConv1", [](EditedFile& f) { f.bypass("conv1_relu"); }},
    {"NoReLUAfterConv2", [](EditedFile& f) { f.bypass("conv2_relu"); }},
    {"NoReLUAfterSpeed1", [](EditedFile& f) { f.bypass("speed1_relu"); }},
    {"NoReLUAfterSpeed2", [](EditedFile& f) { f.bypass("speed2_relu"); }},
    {"NoReLUAfterGain1", [](EditedFile& f) { f.bypass("gain1_relu"); }},
    {"LeakyReLU", [](EditedFile& f) { replace(f, "conv2_relu", "LeakyRelu"); }},
    {"ReLUOfAnotherDomain", [](EditedFile& f) { f.node("conv1_relu").set_domain("com.example"); }},
    {"TanhForTheGain", [](EditedFile& f) { replace(f, "gain", "Tanh"); }},
    {"HardSigmoid", [](EditedFile& f) { replace(f, "gain", "HardSigmoid"); }},
    {"NoSigmoid",
     [](EditedFile& f) {
       f.bypass("gain");
       f.graph().mutable_output()->RemoveLast();
     }},
    {"FlattenedFromTheFirst", [](EditedFile& f) { f.set("features", "axis", 0); }},
    {"FlattenedFromTheSecond", [](EditedFile& f) { f.set("features", "axis", 2); }},
    {"ReshapedToRows",
     [](EditedFile& f) {
       reshape_to(f, {-1, 160});
     }},
    {"ReshapedToThree",
     [](EditedFile& f) {
       reshape_to(f, {0, 16, 20});
     }},
    {"ReshapedToOneWindow",
     [](EditedFile& f) {
       reshape_to(f, {1, -1});
     }},
    {"ReshapedToTheUnknown",
     [](EditedFile& f) {
       reshape_to(f, {-1, -1});
     }},
    {"ScaledGemm", [](EditedFile& f) { add_beta(f, 0.5F); }},
    {"TransposedInput", [](EditedFile& f) { f.set("speed2", "transA", 1); }},
    {"GainAndRestSwapped",
     [](EditedFile& f) {
       rewire(f, "thermal_share", 1, "gyro");
       rewire(f, "gyro_share", 1, "thermal");
     }},
    {"GainMinusOne", [](EditedFile& f) { f.node("gyro_gain").mutable_input()->SwapElements(0, 1); }},
    {"TwoMinusGain",
     [](EditedFile& f) {
       const float two = 2.0F;
       f.tensor("one").set_raw_data(&two, 4);
     }},
    {"GainForBoth", [](EditedFile& f) { rewire(f, "gyro_share", 0, "gain"); }},
    {"ProductOfBoth", [](EditedFile& f) { replace(f, "fusion", "Mul"); }},
    {"Difference", [](EditedFile& f) { replace(f, "fusion", "Sub"); }},
    {"GyroAlone", [](EditedFile& f) { rewire(f, "thermal_share", 1, "gyro"); }},
    {"ThermalIsAnotherValue",
     [](EditedFile& f) {
       f.graph().mutable_output(1)->set_name("gain");
       f.graph().mutable_output(2)->set_name("gain2");
     }},
    {"HeadsBeginApart",
     [](EditedFile& f) {
       f.insert("gain1", "Flatten", {"conv2"}, "other");
       rewire(f, "gain1", 0, "other");
     }},
    {"ExtraLayer",
     [](EditedFile& f) {
       f.insert("conv2", "Relu", {"pool"}, "again");
       rewire(f, "conv2", 0, "again");
     }},
    {"UsesWhatComesLater", [](EditedFile& f) { rewire(f, "conv1_relu", 0, "fusion"); }},
    {"UsesItself", [](EditedFile& f) { rewire(f, "conv1_relu", 0, "conv1_relu"); }},
    {"UsesNothing", [](EditedFile& f) { rewire(f, "conv1_relu", 0, ""); }},
    {"NodeWithoutInputs", [](EditedFile& f) { f.node("conv1_relu").clear_input(); }},
    {"NameTwice", [](EditedFile& f) { f.node("speed1_relu").set_output(0, "speed1"); }},
    {"TensorTwice", [](EditedFile& f) { *f.graph().add_initializer() = f.tensor("conv1.bias"); }},
    {"TensorMissing", [](EditedFile& f) { f.tensor("conv1.bias").set_name("conv1.other"); }},
    {"OutputOfNothing", [](EditedFile& f) { f.node("fusion").set_output(0, "elsewhere"); }},
    {"SecondOutputOfANode",
     [](EditedFile& f) {
       f.node("fusion").set_output(0, "sum");
       f.node("pool").add_output("fusion");
     }},
    {"FurtherOutput", [](EditedFile& f) { f.graph().add_output()->set_name("features"); }},
    {"GainWithoutFusion", [](EditedFile& f) { f.graph().mutable_output()->DeleteSubrange(0, 1); }},
    {"NoOutput", [](EditedFile& f) { f.graph().clear_output(); }},
    {"FurtherInput",
     [](EditedFile& f) {
       *f.graph().add_input() = f.graph().input(1);
       f.graph().mutable_input(2)->set_name("other");
     }},
    {"NoNodes", [](EditedFile& f) { f.graph().clear_node(); }},
    {"Quantised", [](EditedFile& f) { f.graph().add_quantization_annotation(); }},
    {"FunctionsOfItsOwn", [](EditedFile& f) { f.file().add_functions(); }},
    {"GraphInTheGraph", [](EditedFile& f) { f.node("conv1").add_attribute()->mutable_g(); }},
};

INSTANTIATE_TEST_SUITE_P(Of, OtherGraph, testing::ValuesIn(changes),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace thermorig::model
