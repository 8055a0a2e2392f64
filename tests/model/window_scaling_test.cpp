// SPDX-License-Identifier: MIT
// Files of networks that scale each window by itself: their graphs take degrees and give deg/s.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <cstdio>
#include <fstream>

#include "edited_file.h"
#include "session/temporary_folder.h"
#include "thermorig/core/frame.h"
#include "thermorig/network/estimator.h"

namespace thermorig::model {
namespace {

Model model_by_window(const network::Shape& shape) {
  Model model = sample_model(shape);
  model.scaling = network::scaling_by_window(150.0F);
  model.scaling.gate_states_sigma = shape.fusion;
  model.provenance.view = network::CameraView{.width_deg = 54.25, .half_frames = false, .mirrored = true};
  model.provenance.made_windows = 1'000'000;
  model.provenance.begun_from = "the general model, weights 1234abcd";
  return model;
}

const network::Shape smallest{.frames = 2, .reduction = 3};

TEST(ModelFileByWindow, ComesBackForEveryShape) {
  for (const network::Shape& shape : all_shapes()) {
    const Model written = model_by_window(shape);
    const Model read = reread(to_onnx(written));
    EXPECT_EQ(read.weights, written.weights);
    EXPECT_EQ(read.scaling, written.scaling);
    EXPECT_EQ(read.provenance.view, written.provenance.view);
    EXPECT_EQ(read.provenance.made_windows, written.provenance.made_windows);
    EXPECT_EQ(read.provenance.begun_from, written.provenance.begun_from);
  }
}

TEST(ModelFileByWindow, MayNotKnowItsCamera) {
  Model written = model_by_window(smallest);
  written.provenance.view.reset();
  EXPECT_FALSE(reread(to_onnx(written)).provenance.view);
}

TEST(ModelFileByWindow, IsRefusedWhereItsGraphScalesOtherwise) {
  const auto refused = [](auto change) {
    EditedFile file(model_by_window(smallest));
    change(file);
    return refusal_of(file.bytes());
  };
  const auto number = [](EditedFile& file, const char* name, float value) {
    file.tensor(name).set_raw_data(&value, sizeof value);
  };
  using testing::HasSubstr;
  EXPECT_EQ(refused([](EditedFile&) {}), "");
  EXPECT_THAT(refused([&](EditedFile& f) { number(f, "outlier", 2.5F); }), HasSubstr("not known here"));
  EXPECT_THAT(refused([](EditedFile& f) { f.node("shift_3").set_input(1, "in_row_3"); }),
              HasSubstr("not known here"));
  EXPECT_THAT(refused([](EditedFile& f) {
                f.set("averaged", "strides", std::vector<std::int64_t>{2, 2});
              }),
              HasSubstr("not known here"));
  EXPECT_THAT(refused([&](EditedFile& f) { number(f, "speed_scale", 20.0F); }),
              HasSubstr("frame_period_s say"));
  EXPECT_THAT(refused([](EditedFile& f) { f.node("thermal").set_input(0, "speed3"); }),
              HasSubstr("another network"));
  EXPECT_THAT(refused([](EditedFile& f) { f.node("conv1").set_input(0, "unclamped"); }),
              HasSubstr("and not both"));
  EXPECT_THAT(refused([](EditedFile& f) { f.set_key("scaling", "row"); }), HasSubstr("scaled by 'row'"));
  EXPECT_THAT(refused([](EditedFile& f) { f.remove_key("scaling"); }), HasSubstr("version"));
  EXPECT_THAT(refused([](EditedFile& f) { f.set_key("frame_period_s", "0"); }), HasSubstr("frame_period_s"));
  EXPECT_THAT(refused([](EditedFile& f) { f.set_key("crop_left", "1"); }), HasSubstr("crop_left"));
}

TEST(ModelFileByWindow, MadeElsewhereSaysInItsMetadataHowFramesAreScaled) {
  EditedFile file;  // a graph without scaling
  file.keep_scaling_alone();
  file.remove_key("temp_mean_c");
  file.remove_key("temp_deviation_c");
  file.set_key("scaling", "window");
  EXPECT_THAT(refusal_of(file.bytes()), testing::HasSubstr("frame_period_s"));
  file.set_key("frame_period_s", "0.125");
  const Model read = reread(file.bytes());
  EXPECT_TRUE(read.scaling.by_window);
  EXPECT_FALSE(read.scaling.gate_states_sigma);
}

class GraphByWindow : public session::InTemporaryFolder {
 protected:
  /// What numpy makes of the file and a window.
  std::vector<double> run(const Model& model, std::span<const float> temp_c, float period_s, float gyro_dps) {
    const std::string file = folder_ / "model.onnx", inputs = folder_ / "inputs";
    std::filesystem::remove(file);
    write_model(file, model);
    std::ofstream out(inputs, std::ios::binary);
    out.write(reinterpret_cast<const char*>(temp_c.data()),
              static_cast<std::streamsize>(temp_c.size_bytes()));
    for (const float value : {period_s, gyro_dps})
      out.write(reinterpret_cast<const char*>(&value), sizeof value);
    out.close();
    const std::string command = fmt::format(
        "/usr/bin/python3 " THERMORIG_SOURCE_DIR "/tests/model/run_graph.py {} {} 2>&1", file, inputs);
    FILE* pipe = ::popen(command.c_str(), "r");
    std::vector<double> printed;
    for (double value = 0.0; std::fscanf(pipe, "%lf", &value) == 1;) printed.push_back(value);
    EXPECT_EQ(::pclose(pipe), 0);
    return printed;
  }

  static std::vector<float> window_c(int frames) {
    std::vector<float> temp_c(static_cast<std::size_t>(frames) * frame_pixels);
    for (std::size_t i = 0; i < temp_c.size(); ++i) {
      const auto place = static_cast<double>(i % frame_pixels), frame = static_cast<double>(i / frame_pixels);
      temp_c[i] = static_cast<float>(24.0 + 1.5 * std::sin(0.37 * place + 0.8 * frame) + 0.02 * place);
    }
    temp_c[400] = 90.0F;  // an outlier
    return temp_c;
  }
};

TEST_F(GraphByWindow, GivesTheSpeedsThatTheProgramGives) {
  for (const network::Shape& shape :
       {network::Shape{.frames = 3, .reduction = 1}, network::Shape{.frames = 4, .reduction = 2},
        network::Shape{.frames = 2, .reduction = 3, .fusion = false}}) {
    const Model model = model_by_window(shape);
    const std::vector<float> temp_c = window_c(shape.frames);
    std::vector<float> window(shape.inputs());
    for (std::size_t frame = 0; frame < static_cast<std::size_t>(shape.frames); ++frame)
      network::prepare_frame(std::span(temp_c).subspan(frame * frame_pixels, frame_pixels), shape,
                             model.scaling,
                             std::span(window).subspan(frame * shape.pixels(), shape.pixels()));
    network::scale_window(window, shape);
    const float scale_dps = model.scaling.speed_scale_dps(0.25);
    const network::Output expected = network::Estimator(model.weights).estimate(window, 30.0F / scale_dps);
    const std::vector<double> found = run(model, temp_c, 0.25F, 30.0F);
    constexpr double tolerance_dps = 2e-3;  // 1e-5 of 200 deg/s
    if (shape.fusion) {
      ASSERT_EQ(found.size(), 3U);
      EXPECT_NEAR(found[0], expected.fusion * scale_dps, tolerance_dps);
      EXPECT_NEAR(found[2], expected.gain, 1e-5);
    }
    ASSERT_FALSE(found.empty());
    EXPECT_NEAR(found[shape.fusion ? 1 : 0], expected.thermal * scale_dps, tolerance_dps);
  }
}

}  // namespace
}  // namespace thermorig::model
