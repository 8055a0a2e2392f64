// SPDX-License-Identifier: MIT
#include "sample_models.h"

#include <gtest/gtest.h>

#include "thermorig/core/error.h"

namespace thermorig::model {

Model sample_model(const network::Shape& shape, std::uint64_t seed) {
  Model model;
  model.weights = network::initial_weights(shape, seed);
  model.scaling = {200.0F, 23.456789F, 2.7182817F};
  model.provenance = {"thermorig 0.1.0",
                      "best",
                      18446744073709551615U,
                      40,
                      17,
                      {{"garden_acq-01", std::string(64, 'a')}, {"küche acq 02", std::string(64, 'b')}},
                      {{"garden_acq-03", std::string(64, 'c')}},
                      true,
                      "CC-BY-4.0",
                      Label::corrected};
  return model;
}

Model small_model() {
  return sample_model({.frames = 2, .reduction = 3, .fusion = false, .crop_left = 1});
}

std::vector<network::Shape> all_shapes() {
  std::vector<network::Shape> shapes;
  for (int frames = network::min_frames; frames <= network::max_frames; ++frames)
    for (int reduction = network::min_reduction; reduction <= network::max_reduction; ++reduction)
      for (const bool fusion : {true, false})
        shapes.push_back({.frames = frames, .reduction = reduction, .fusion = fusion});
  return shapes;
}

std::string refusal_of(const std::string& file) {
  try {
    reread(file);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::not_a_session);
    EXPECT_EQ(error.where(), "sample.onnx");
    EXPECT_FALSE(error.advice().empty());
    return error.what_happened() + " | " + error.advice();
  }
  return "";
}

}  // namespace thermorig::model
