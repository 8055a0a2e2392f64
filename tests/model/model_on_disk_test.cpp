// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "sample_models.h"
#include "session/temporary_folder.h"
#include "thermorig/core/error.h"

namespace thermorig::model {
namespace {

namespace fs = std::filesystem;

class ModelOnDisk : public session::InTemporaryFolder {
 protected:
  std::string refusal_of_reading(const fs::path& file) {
    try {
      read_model(file);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::not_a_session);
      EXPECT_EQ(error.where(), file.string());
      return error.what_happened();
    }
    return "";
  }
};

TEST_F(ModelOnDisk, ComesBack) {
  const Model written = sample_model({});
  write_model(path("model.onnx"), written);
  EXPECT_EQ(read_model(path("model.onnx")).weights, written.weights);
}

TEST_F(ModelOnDisk, IsTheSameFileForTheSameModel) {
  write_model(path("a.onnx"), small_model());
  write_model(path("b.onnx"), small_model());
  EXPECT_EQ(read_file(path("a.onnx")), read_file(path("b.onnx")));
}

TEST_F(ModelOnDisk, IsRefusedByItsSizeAlone) {
  std::ofstream(path("large.onnx")).put('x');
  fs::resize_file(path("large.onnx"), std::uintmax_t{1} << 40U);
  EXPECT_THAT(refusal_of_reading(path("large.onnx")), testing::HasSubstr("more than the 8388608"));
}

TEST_F(ModelOnDisk, SaysWhatElseIsThere) {
  EXPECT_EQ(refusal_of_reading(path("none.onnx")), "cannot read the model: No such file or directory");
  EXPECT_EQ(refusal_of_reading(folder_), "cannot read the model: it is a folder");
  std::ofstream(path("empty.onnx")).close();
  EXPECT_EQ(refusal_of_reading(path("empty.onnx")), "it is empty");
}

TEST_F(ModelOnDisk, IsNotWrittenWhereThereIsNoFolder) {
  try {
    write_model(path("none") / "model.onnx", small_model());
    FAIL() << "written into a folder that does not exist";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::storage);
    EXPECT_EQ(error.advice(), "create the folder first, or choose another");
  }
}

}  // namespace
}  // namespace thermorig::model
