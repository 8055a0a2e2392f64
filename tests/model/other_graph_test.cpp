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

const Change changes[] = {
    {"StrideTwo",
     [](EditedFile& f) {
       f.set("conv1", "strides", {2, 2});
     }},
    {"PaddedByOne",
     [](EditedFile& f) {
       f.set("conv1", "pads", {1, 1, 1, 1});
     }},
    {"FurtherAttribute", [](EditedFile& f) { f.set("conv2", "group", 2); }},
    {"PooledByMean", [](EditedFile& f) { replace(f, "pool", "AveragePool"); }},
    {"ReLUOfAnotherDomain", [](EditedFile& f) { f.node("conv1_relu").set_domain("com.example"); }},
    {"TanhForTheGain", [](EditedFile& f) { replace(f, "gain", "Tanh"); }},
    {"GainMinusOne", [](EditedFile& f) { f.node("gyro_gain").mutable_input()->SwapElements(0, 1); }},
    {"TwoMinusGain",
     [](EditedFile& f) {
       const float two = 2.0F;
       f.tensor("one").set_raw_data(&two, 4);
     }},
    {"OneMissing", [](EditedFile& f) { f.tensor("one").set_name("two"); }},
    {"GyroAlone", [](EditedFile& f) { rewire(f, "thermal_share", 1, "gyro"); }},
    {"UsesItself", [](EditedFile& f) { rewire(f, "conv1_relu", 0, "conv1_relu"); }},
    {"NodeWithoutInputs", [](EditedFile& f) { f.node("conv1_relu").clear_input(); }},
    {"NodeMissing", [](EditedFile& f) { f.graph().mutable_node()->RemoveLast(); }},
    {"NodeTwice", [](EditedFile& f) { *f.graph().add_node() = f.node("fusion"); }},
    {"NoNodes", [](EditedFile& f) { f.graph().clear_node(); }},
    {"FurtherOutput", [](EditedFile& f) { f.graph().add_output()->set_name("features"); }},
    {"NoOutput", [](EditedFile& f) { f.graph().clear_output(); }},
    {"FurtherInput", [](EditedFile& f) { *f.graph().add_input() = f.graph().input(1); }},
    {"NoInput", [](EditedFile& f) { f.graph().clear_input(); }},
    {"InputOfOtherSize",
     [](EditedFile& f) {
       f.graph()
           .mutable_input(0)
           ->mutable_type()
           ->mutable_tensor_type()
           ->mutable_shape()
           ->mutable_dim(2)
           ->set_dim_value(12);
     }},
    {"NegativeBatch",
     [](EditedFile& f) {
       f.graph()
           .mutable_input(0)
           ->mutable_type()
           ->mutable_tensor_type()
           ->mutable_shape()
           ->mutable_dim(0)
           ->set_dim_value(-1);
     }},
    {"Quantised", [](EditedFile& f) { f.graph().add_quantization_annotation(); }},
    {"GraphInTheGraph", [](EditedFile& f) { f.node("conv1").add_attribute()->mutable_g(); }},
};

INSTANTIATE_TEST_SUITE_P(Of, OtherGraph, testing::ValuesIn(changes),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace thermorig::model
