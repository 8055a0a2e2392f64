// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>

#include "sample_models.h"
#include "session/temporary_folder.h"

namespace thermorig::model {
namespace {

class OnnxChecker : public session::InTemporaryFolder {};

std::string output_of(const std::string& command) {
  FILE* pipe = ::popen(command.c_str(), "r");
  std::string text;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
  EXPECT_EQ(::pclose(pipe), 0) << text;
  return text;
}

TEST_F(OnnxChecker, AcceptsEveryShape) {
  std::string paths, expected;
  for (const network::Shape& shape : all_shapes()) {
    const std::string file = fmt::format("{}/nf{}_nr{}_{}.onnx", folder_.string(), shape.frames,
                                         shape.reduction, shape.fusion ? "fusion" : "thermal");
    Model model = sample_model(shape);
    if (shape.frames % 2 == 0) model.scaling = network::scaling_by_window();
    write_model(file, model, shape.frames == 4 ? 1 : 0);
    paths += fmt::format(" {}", file);
    expected += fmt::format("{}\n", file);
  }
  const std::string script = THERMORIG_SOURCE_DIR "/tests/model/check_onnx.py";
  EXPECT_EQ(output_of(fmt::format("/usr/bin/python3 {}{} 2>&1", script, paths)), expected);
}

}  // namespace
}  // namespace thermorig::model
