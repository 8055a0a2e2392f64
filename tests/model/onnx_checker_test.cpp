// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <cstdio>
#include <filesystem>

#include "sample_models.h"

namespace thermorig::model {
namespace {

namespace fs = std::filesystem;

/// A folder that goes with the test.
class OnnxChecker : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "thermorig_model_XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path folder_;
};

std::string output_of(const std::string& command) {
  FILE* pipe = ::popen(command.c_str(), "r");
  std::string text;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
  EXPECT_EQ(::pclose(pipe), 0) << text;
  return text;
}

TEST_F(OnnxChecker, AcceptsEveryShape) {
  std::string files, expected;
  for (const network::Shape& shape : all_shapes()) {
    const std::string path = fmt::format("{}/nf{}_nr{}_{}.onnx", folder_.string(), shape.frames,
                                         shape.reduction, shape.fusion ? "fusion" : "thermal");
    write_model(path, sample_model(shape), shape.frames == 4 ? 1 : 0);
    files += fmt::format(" {}", path);
    expected += fmt::format("{}\n", path);
  }
  const std::string script = THERMORIG_SOURCE_DIR "/tests/model/check_onnx.py";
  EXPECT_EQ(output_of(fmt::format("/usr/bin/python3 {}{} 2>&1", script, files)), expected);
}

}  // namespace
}  // namespace thermorig::model
