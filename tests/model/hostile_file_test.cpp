// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <functional>
#include <limits>

#include "edited_file.h"

namespace thermorig::model {
namespace {

struct Damage {
  const char* name;
  const char* said;  // a part of the refusal
  std::function<void(EditedFile&)> apply;
};

void PrintTo(const Damage& damage, std::ostream* out) {
  *out << damage.name;
}

class HostileFile : public testing::TestWithParam<Damage> {};

TEST_P(HostileFile, IsRefusedWithItsReason) {
  EditedFile file;
  GetParam().apply(file);
  EXPECT_THAT(refusal_of(file.bytes()), testing::HasSubstr(GetParam().said));
}

void put_value(EditedFile& file, const char* name, float value) {
  std::string& raw = *file.tensor(name).mutable_raw_data();
  std::memcpy(raw.data() + raw.size() - sizeof value, &value, sizeof value);
}

void refer_outside(EditedFile& file) {
  onnx::TensorProto& tensor = file.tensor("speed1.weight");
  tensor.clear_raw_data();
  tensor.set_data_location(onnx::TensorProto::EXTERNAL);
  onnx::StringStringEntryProto& entry = *tensor.add_external_data();
  entry.set_key("location");
  entry.set_value("../../etc/passwd");
}

onnx::TensorShapeProto& frames_shape(EditedFile& file) {
  return *file.graph().mutable_input(0)->mutable_type()->mutable_tensor_type()->mutable_shape();
}

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr std::int64_t huge = std::numeric_limits<std::int64_t>::max();

const Damage tensors[] = {
    {"NaN", "'gain1.weight' holds NaN or infinity", [](EditedFile& f) { put_value(f, "gain1.weight", nan); }},
    {"Infinity", "'conv1.bias' holds NaN or infinity",
     [](EditedFile& f) { put_value(f, "conv1.bias", infinity); }},
    {"MinusInfinity", "holds NaN or infinity",
     [](EditedFile& f) { put_value(f, "speed2.weight", -infinity); }},
    {"OtherWeights", "differ from their checksum",
     [](EditedFile& f) { put_value(f, "speed2.weight", 1.0F); }},
    {"HugeDimension", "'speed1.weight' has the dimensions (120, 9223372036854775807)",
     [](EditedFile& f) { f.tensor("speed1.weight").set_dims(1, huge); }},
    {"NegativeDimension", "has the dimensions",
     [](EditedFile& f) { f.tensor("speed1.weight").set_dims(0, -120); }},
    {"WrappingDimensions", "has the dimensions",
     [](EditedFile& f) { f.tensor("conv1.bias").set_dims(0, (std::int64_t{1} << 32) + 6); }},
    {"DimensionsSwapped", "has the dimensions (320, 120), not (120, 320)",
     [](EditedFile& f) { f.tensor("speed1.weight").mutable_dims()->SwapElements(0, 1); }},
    {"NoDimensions", "has the dimensions ()", [](EditedFile& f) { f.tensor("conv2.weight").clear_dims(); }},
    {"FurtherDimension", "has the dimensions (6, 1)",
     [](EditedFile& f) { f.tensor("conv1.bias").add_dims(1); }},
    {"TooFewValues", "'conv1.bias' has 20 bytes of values, its dimensions need 24",
     [](EditedFile& f) { f.tensor("conv1.bias").mutable_raw_data()->resize(20); }},
    {"TooManyValues", "has 28 bytes of values",
     [](EditedFile& f) { f.tensor("conv1.bias").mutable_raw_data()->resize(28); }},
    {"HalfAValue", "has 23 bytes of values",
     [](EditedFile& f) { f.tensor("conv1.bias").mutable_raw_data()->resize(23); }},
    {"NoValues", "has 0 bytes of values", [](EditedFile& f) { f.tensor("conv1.bias").clear_raw_data(); }},
    {"ValuesTwice", "bytes of values", [](EditedFile& f) { f.tensor("conv1.bias").add_float_data(1.0F); }},
    {"Doubles", "is not made of 32-bit floats",
     [](EditedFile& f) { f.tensor("conv1.bias").set_data_type(onnx::TensorProto::DOUBLE); }},
    {"Halves", "is not made of 32-bit floats",
     [](EditedFile& f) { f.tensor("conv1.bias").set_data_type(onnx::TensorProto::FLOAT16); }},
    {"Integers", "is not made of 32-bit floats",
     [](EditedFile& f) { f.tensor("conv1.bias").set_data_type(onnx::TensorProto::INT32); }},
    {"UnknownType", "is not made of 32-bit floats",
     [](EditedFile& f) { f.tensor("conv1.bias").set_data_type(12345); }},
    {"External", "the values of 'speed1.weight' lie in another file | store them inside", refer_outside},
    {"Segment", "is only a part of a tensor",
     [](EditedFile& f) { f.tensor("conv1.bias").mutable_segment()->set_end(3); }},
    {"WeightIsAnInput", "conv1.weight is not in the file: it comes from the input",
     [](EditedFile& f) {
       f.tensor("conv1.weight").set_name("other");
       f.graph().add_input()->set_name("conv1.weight");
     }},
};

const Damage shapes[] = {
    {"SevenFrames", "a window has 2 to 6 frames",
     [](EditedFile& f) { frames_shape(f).mutable_dim(1)->set_dim_value(7); }},
    {"OtherFrames", "'conv1.weight' has the dimensions (6, 2, 5, 5), not (6, 3, 5, 5)",
     [](EditedFile& f) {
       f.keep_scaling_alone();
       frames_shape(f).mutable_dim(1)->set_dim_value(3);
     }},
    {"OtherRows", "not 24 x 32, 12 x 16 or 8 x 10 pixels but 12 x 10",
     [](EditedFile& f) { frames_shape(f).mutable_dim(2)->set_dim_value(12); }},
    {"HugeRows", "pixels but 0 x 10",
     [](EditedFile& f) { frames_shape(f).mutable_dim(2)->set_dim_value(huge); }},
    {"NegativeColumns", "pixels but 8 x 0",
     [](EditedFile& f) { frames_shape(f).mutable_dim(3)->set_dim_value(-10); }},
    {"OpenRows", "pixels but 0 x 10",
     [](EditedFile& f) { frames_shape(f).mutable_dim(2)->set_dim_param("H"); }},
    {"ThreeDimensions", "'frames' has 3 dimensions, not 4",
     [](EditedFile& f) { frames_shape(f).mutable_dim()->RemoveLast(); }},
    {"NoShape", "'frames' has 0 dimensions",
     [](EditedFile& f) { f.graph().mutable_input(0)->mutable_type()->mutable_tensor_type()->clear_shape(); }},
    {"NoType", "'frames' is not made of 32-bit floats",
     [](EditedFile& f) { f.graph().mutable_input(0)->clear_type(); }},
    {"HalfFrames", "'frames' is not made of 32-bit floats",
     [](EditedFile& f) {
       f.graph().mutable_input(0)->mutable_type()->mutable_tensor_type()->set_elem_type(10);
     }},
    {"PaddedByThree", "conv1 is not padded by 0, 1 or 2",
     [](EditedFile& f) {
       f.set("conv1", "pads", {3, 3, 3, 3});
     }},
    {"PaddedOnOneSide", "conv1 is not padded by 0, 1 or 2",
     [](EditedFile& f) {
       f.set("conv1", "pads", {2, 2, 1, 1});
     }},
    {"PaddedBelowNothing", "conv2 is not padded by 0, 1 or 2",
     [](EditedFile& f) {
       f.set("conv2", "pads", {-1, -1, -1, -1});
     }},
    {"NoPads", "conv2 is not padded by 0, 1 or 2",
     [](EditedFile& f) { f.set("conv2", "pads", std::vector<std::int64_t>{}); }},
    {"NothingLeft", "nothing is left after the second convolution",
     [](EditedFile& f) {
       f.set("conv2", "pads", {0, 0, 0, 0});
     }},
    {"NamedOtherwise", "its input 'images' should be named 'frames'",
     [](EditedFile& f) {
       f.graph().mutable_input(0)->set_name("images");
       f.node("conv1").set_input(0, "images");
     }},
};

const Damage metadata[] = {
    {"NoScale", "it does not say its label_scale_dps | write label_scale_dps",
     [](EditedFile& f) {
       f.keep_scaling_alone();
       f.remove_key("label_scale_dps");
     }},
    {"NoDeviation", "it does not say its temp_deviation_c",
     [](EditedFile& f) {
       f.keep_scaling_alone();
       f.remove_key("temp_deviation_c");
     }},
    {"DeviationOfZero", "its temp_deviation_c is not between",
     [](EditedFile& f) { f.set_key("temp_deviation_c", "0"); }},
    {"NegativeDeviation", "its temp_deviation_c is not between",
     [](EditedFile& f) { f.set_key("temp_deviation_c", "-1"); }},
    {"DeviationNaN", "its temp_deviation_c is not between",
     [](EditedFile& f) { f.set_key("temp_deviation_c", "nan"); }},
    {"MeanNaN", "its temp_mean_c is not between", [](EditedFile& f) { f.set_key("temp_mean_c", "nan"); }},
    {"ScaleInfinite", "its label_scale_dps is not between",
     [](EditedFile& f) { f.set_key("label_scale_dps", "inf"); }},
    {"ScaleZero", "its label_scale_dps is not between",
     [](EditedFile& f) { f.set_key("label_scale_dps", "0"); }},
    {"ScaleTooLong", "is no such number", [](EditedFile& f) { f.set_key("label_scale_dps", "1e99"); }},
    {"ScaleWithUnit", "label_scale_dps is '200 deg/s', which is no such number",
     [](EditedFile& f) { f.set_key("label_scale_dps", "200 deg/s"); }},
    {"ScaleEmpty", "is no such number", [](EditedFile& f) { f.set_key("label_scale_dps", ""); }},
    {"OtherFrames", "its metadata says frames = 5, its graph shows 2",
     [](EditedFile& f) { f.set_key("frames", "5"); }},
    {"OtherReduction", "its metadata says reduction = 1, its graph shows 3",
     [](EditedFile& f) { f.set_key("reduction", "1"); }},
    {"OtherPadding", "its metadata says padding2 = 1", [](EditedFile& f) { f.set_key("padding2", "1"); }},
    {"OtherNetwork", "its metadata says 'thermal-only', its graph is fusion",
     [](EditedFile& f) { f.set_key("network", "thermal-only"); }},
    {"CroppedTooMuch", "its metadata does not fit", [](EditedFile& f) { f.set_key("crop_left", "3"); }},
    {"NewerFormat", "it is a model file of version '2', this program knows versions 1 and 2",
     [](EditedFile& f) { f.set_key("format_version", "2"); }},
    {"SeedMissing", "its metadata lacks 'seed'", [](EditedFile& f) { f.remove_key("seed"); }},
    {"SeedNegative", "is no such number", [](EditedFile& f) { f.set_key("seed", "-1"); }},
    {"EpochAfterTheLast", "it claims to keep epoch 41 of 40",
     [](EditedFile& f) { f.set_key("epoch_kept", "41"); }},
    {"NegativeEpochs", "it claims to keep epoch", [](EditedFile& f) { f.set_key("epochs", "-3"); }},
    {"NeitherTrueNorFalse", "neither true nor false", [](EditedFile& f) { f.set_key("simulated", "maybe"); }},
    {"LabelUnknown", "its metadata label is 'rate_shaft', which is no label known here",
     [](EditedFile& f) { f.set_key("label", "rate_shaft"); }},
    {"KeyTwice", "its metadata has 'seed' twice",
     [](EditedFile& f) { *f.file().add_metadata_props() = f.file().metadata_props(12); }},
    {"EscapeCodes", "its metadata 'data_licence' is no plain text",
     [](EditedFile& f) { f.set_key("data_licence", "\x1b[2Jfree"); }},
    {"LineBreak", "is no plain text", [](EditedFile& f) { f.set_key("preset", "best\nlicence: free"); }},
    {"NoUtf8", "is no plain text", [](EditedFile& f) { f.set_key("preset", "\xc3\x28"); }},
    {"TurnedText", "is no plain text",
     [](EditedFile& f) {
       f.set_key("preset",
                 "\xe2\x80\xae"
                 "tseb");
     }},
    {"LongText", "is no plain text", [](EditedFile& f) { f.set_key("preset", std::string(1001, 'x')); }},
    {"EscapeCodesInAKey", "its metadata '?[2J' is no plain text",
     [](EditedFile& f) { f.set_key("\x1b[2J", ""); }},
    {"DataWithoutHash", "is not a hash and a name",
     [](EditedFile& f) { f.set_key("training_data_2", "garden"); }},
};

const Damage files[] = {
    {"NoGraph", "it has no graph", [](EditedFile& f) { f.file().clear_graph(); }},
    {"NoOperatorVersion", "does not say which version", [](EditedFile& f) { f.file().clear_opset_import(); }},
    {"OldOperators", "made for version 8 of ONNX's operators",
     [](EditedFile& f) { f.file().mutable_opset_import(0)->set_version(8); }},
    {"FutureOperators", "made for version 9223372036854775807",
     [](EditedFile& f) { f.file().mutable_opset_import(0)->set_version(huge); }},
    {"TwoOperatorVersions", "does not say which version",
     [](EditedFile& f) { f.file().add_opset_import()->set_version(13); }},
    {"Functions", "its graph has functions, sparse", [](EditedFile& f) { f.file().add_functions(); }},
    {"SparseTensors", "sparse or quantised", [](EditedFile& f) { f.graph().add_sparse_initializer(); }},
};

const auto name_of = [](const auto& test) { return std::string(test.param.name); };
INSTANTIATE_TEST_SUITE_P(Tensor, HostileFile, testing::ValuesIn(tensors), name_of);
INSTANTIATE_TEST_SUITE_P(Shape, HostileFile, testing::ValuesIn(shapes), name_of);
INSTANTIATE_TEST_SUITE_P(Metadata, HostileFile, testing::ValuesIn(metadata), name_of);
INSTANTIATE_TEST_SUITE_P(File, HostileFile, testing::ValuesIn(files), name_of);

TEST(OtherBytes, AreNamedWhereTheyAreKnown) {
  EXPECT_THAT(refusal_of(""), testing::StartsWith("it is empty"));
  EXPECT_THAT(refusal_of("\x89HDF\r\n\x1a\n rest"), testing::StartsWith("it is an HDF5 file"));
  EXPECT_THAT(refusal_of(std::string("PK\x03\x04 rest")), testing::HasSubstr("torch.onnx.export"));
  EXPECT_THAT(refusal_of("version https://git-lfs.github.com/spec/v1\noid sha256:01\nsize 9\n"),
              testing::HasSubstr("git lfs pull"));
  EXPECT_THAT(refusal_of("#!/bin/sh\nexit 0\n"), testing::StartsWith("it is no ONNX file"));
  EXPECT_THAT(refusal_of(std::string(1000, '\0')), testing::StartsWith("it is no ONNX file"));
  EXPECT_THAT(refusal_of(std::string(1000, '\xff')), testing::StartsWith("it is no ONNX file"));
}

TEST(TruncatedFile, IsRefusedAtEveryLength) {
  const std::string whole = to_onnx(small_model());
  for (std::size_t size = 0; size < whole.size(); size += size < 2000 || size + 4000 > whole.size() ? 1 : 997)
    ASSERT_NE(refusal_of(whole.substr(0, size)), "") << size;
}

}  // namespace
}  // namespace thermorig::model
