// SPDX-License-Identifier: MIT
// What half-precision weights change in the speeds of a trained model, over all windows of sessions.
//   network_fp16_difference MODEL.onnx SESSION.h5...      prints JSON
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "thermorig/core/error.h"
#include "thermorig/learning/dataset/dataset.h"
#include "thermorig/network/estimator.h"
#include "thermorig/network/model/model.h"
#include "thermorig/network/scaling.h"
#include "thermorig/network/window_index.h"

namespace {

using namespace thermorig;

struct Differences {
  std::size_t windows = 0;
  float fusion = 0.0F, thermal = 0.0F;  // largest, normalised
};

void look_at(const model::Model& model, const network::Acquisition& acquisition, Differences& differences) {
  const network::Shape& shape = model.weights.shape;
  network::Estimator full(model.weights), half(model.weights, network::Precision::fp16_weights);
  const std::vector<float> frames = network::prepare(acquisition, shape, model.scaling);
  for (const auto& window : network::find_windows({&acquisition, 1}, shape.frames)) {
    const std::size_t first = window.last + 1U - static_cast<std::size_t>(shape.frames);
    const auto pixels = std::span(frames).subspan(first * shape.pixels(), shape.inputs());
    const float gyro =
        network::rates_of(acquisition, window, shape.frames).gyro_dps / model.scaling.label_scale_dps;
    const auto a = full.estimate(pixels, gyro), b = half.estimate(pixels, gyro);
    differences.fusion = std::max(differences.fusion, std::abs(a.fusion - b.fusion));
    differences.thermal = std::max(differences.thermal, std::abs(a.thermal - b.thermal));
    ++differences.windows;
  }
}

}  // namespace

int main(int count, char** arguments) try {
  if (count < 3) return 2;
  const model::Model model = model::read_model(arguments[1]);
  Differences differences;
  for (int i = 2; i < count; ++i) look_at(model, dataset::read_acquisition(arguments[i]), differences);
  fmt::print(R"({{"windows": {}, "fusion_dps": {:.4g}, "thermal_dps": {:.4g}}})"
             "\n",
             differences.windows, differences.fusion * model.scaling.label_scale_dps,
             differences.thermal * model.scaling.label_scale_dps);
  return 0;
} catch (const thermorig::Error& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
