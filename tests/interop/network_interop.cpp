// SPDX-License-Identifier: MIT
// Our side of the comparisons with other programs. Binary files hold float32 in the machine's order.
//   network_interop seeded-model NF NR fusion|thermal-only SEED OUT.onnx
//   network_interop weights MODEL.onnx OUT           all weights in the documented order
//   network_interop outputs MODEL.onnx WINDOWS OUT   fusion, thermal, gain of seeded windows
//   network_interop training NF NR fusion|thermal-only AUXILIARY SEED SAMPLES STEPS OUT
//       gradients of the first batch, weights after all steps, losses (float64)
//   network_interop onnx-runtime LIBRARY WINDOWS     largest difference of every shape, a line of JSON each
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "onnx_runtime.h"
#include "seeded_values.h"
#include "thermorig/core/error.h"
#include "thermorig/core/frame.h"
#include "thermorig/network/model/model.h"
#include "thermorig/network/trainer.h"

namespace {

using namespace thermorig;
using Arguments = std::vector<std::string>;

constexpr std::uint64_t batch_seed = 100;

network::Shape shape_of(const std::string& frames, const std::string& reduction, const std::string& mode) {
  network::Shape shape;
  shape.frames = std::stoi(frames);
  shape.reduction = std::stoi(reduction);
  shape.fusion = mode == "fusion";
  return shape;
}

model::Model seeded_model(const network::Shape& shape, std::uint64_t seed) {
  model::Model model;
  model.weights = interop::seeded_weights(shape, seed);
  model.provenance.producer = "interop test";
  return model;
}

template <typename Value>
void append(std::ofstream& file, std::span<const Value> values) {
  file.write(reinterpret_cast<const char*>(values.data()), static_cast<std::streamsize>(values.size_bytes()));
}

void write_seeded_model(const Arguments& a) {
  model::write_model(a.at(4), seeded_model(shape_of(a.at(0), a.at(1), a.at(2)), std::stoull(a.at(3))));
}

void write_weights(const Arguments& a) {
  std::ofstream file(a.at(1), std::ios::binary);
  append<float>(file, model::read_model(a.at(0)).weights.values);
}

void write_outputs(const Arguments& a) {
  const model::Model model = model::read_model(a.at(0));
  const network::Shape& shape = model.weights.shape;
  network::Estimator estimator(model.weights);
  const interop::SeededBatch windows(shape, batch_seed, 0, std::stoul(a.at(1)));
  const network::Batch batch = windows.batch();
  std::ofstream file(a.at(2), std::ios::binary);
  for (std::size_t i = 0; i < batch.frames.size(); ++i) {
    const auto output =
        estimator.estimate({batch.frames[i], shape.inputs()}, shape.fusion ? batch.gyro[i] : 0.0F);
    append<float>(file, std::array{output.fusion, output.thermal, output.gain});
  }
}

void write_training(const Arguments& a) {
  const network::Shape shape = shape_of(a.at(0), a.at(1), a.at(2));
  network::TrainerConfig config;
  config.loss.auxiliary_thermal = std::stof(a.at(3));
  const std::uint64_t seed = std::stoull(a.at(4));
  const std::size_t samples = std::stoul(a.at(5)), steps = std::stoul(a.at(6));
  network::CallingThread workers;
  network::Trainer trainer(interop::seeded_weights(shape, seed), config, workers);
  std::ofstream file(a.at(7), std::ios::binary);
  append<float>(file, trainer.gradients(interop::SeededBatch(shape, seed, 0, samples).batch()));
  std::vector<double> losses;
  for (std::size_t step = 0; step < steps; ++step)
    losses.push_back(trainer.step(interop::SeededBatch(shape, seed, step, samples).batch()).loss);
  append<float>(file, trainer.weights().values);
  append<double>(file, losses);
}

double difference(const network::Output& a, const network::Output& b) {
  return std::max(
      {std::abs(a.fusion - b.fusion), std::abs(a.thermal - b.thermal), std::abs(a.gain - b.gain)});
}

double difference_to_onnx_runtime(const std::string& library, const network::Shape& shape,
                                  std::size_t windows) {
  const model::Model model = seeded_model(shape, batch_seed);
  const std::string bytes = model::to_onnx(model);
  interop::OnnxRuntime peer(library, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()},
                            shape);
  network::Estimator ours(model.weights);
  const interop::SeededBatch owner(shape, batch_seed, 0, windows);
  const network::Batch batch = owner.batch();
  double largest = 0.0;
  for (std::size_t i = 0; i < windows; ++i) {
    const std::span frames{batch.frames[i], shape.inputs()};
    std::ranges::copy(frames, peer.frames().begin());
    peer.gyro() = shape.fusion ? batch.gyro[i] : 0.0F;
    largest = std::max(largest, difference(ours.estimate(frames, peer.gyro()), peer.run()));
  }
  return largest;
}

/// Degrees Celsius of window `number`: a slope and noise over 0.05 to 20 K, in some a pixel that is far off.
std::vector<float> seeded_degrees(const network::Shape& shape, std::size_t number) {
  const std::size_t pixels = static_cast<std::size_t>(shape.frames) * frame_pixels;
  std::vector<float> degrees = interop::seeded_values(batch_seed + 1000 + number, pixels);
  const auto span_c = static_cast<float>(0.05 * std::pow(400.0, static_cast<double>(number % 10) / 9.0));
  for (std::size_t i = 0; i < pixels; ++i)
    degrees[i] = 21.0F + span_c * (degrees[i] + static_cast<float>(i % frame_columns) / frame_columns);
  if (number % 3 == 0) degrees[(number * 37) % pixels] += 60.0F;
  return degrees;
}

/// From a camera's degrees to deg/s, the scaling in the graph: largest difference as a share of the label's
/// scale.
double difference_from_degrees(const std::string& library, const network::Shape& shape, std::size_t windows) {
  model::Model model = seeded_model(shape, batch_seed);
  model.scaling = network::scaling_by_window();
  model.scaling.frame_period_s = 0.125F;
  const std::string bytes = model::to_onnx(model);
  interop::OnnxRuntime peer(library, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()},
                            shape, true);
  network::Estimator ours(model.weights);
  std::vector<float> window(shape.inputs());
  const std::size_t frame_size = shape.inputs() / static_cast<std::size_t>(shape.frames);
  double largest = 0.0;
  for (std::size_t i = 0; i < windows; ++i) {
    const std::vector<float> degrees = seeded_degrees(shape, i);
    std::ranges::copy(degrees, peer.frames().begin());
    peer.period() = 0.0625F * static_cast<float>(1 + i % 4);
    peer.gyro() = 200.0F * interop::seeded_values(batch_seed + i, 1)[0];
    for (std::size_t f = 0; f < static_cast<std::size_t>(shape.frames); ++f)
      network::prepare_frame(std::span(degrees).subspan(f * frame_pixels, frame_pixels), shape, model.scaling,
                             std::span(window).subspan(f * frame_size, frame_size));
    network::scale_window(window, shape);
    const float scale_dps = model.scaling.speed_scale_dps(peer.period());
    const network::Output mine = ours.estimate(window, shape.fusion ? peer.gyro() / scale_dps : 0.0F);
    network::Output theirs = peer.run();
    theirs.fusion /= scale_dps;
    theirs.thermal /= scale_dps;
    largest = std::max(largest, difference(mine, theirs));
  }
  return largest;
}

void compare_onnx_runtime(const Arguments& a) {
  const std::size_t windows = std::stoul(a.at(1));
  for (int frames = network::min_frames; frames <= network::max_frames; ++frames)
    for (int reduction = network::min_reduction; reduction <= network::max_reduction; ++reduction)
      for (bool fusion : {true, false}) {
        const network::Shape shape{.frames = frames, .reduction = reduction, .fusion = fusion};
        fmt::print(R"({{"nf": {}, "nr": {}, "fusion": {}, "difference": {:.3g}, "from_degrees": {:.3g}}})"
                   "\n",
                   frames, reduction, fusion, difference_to_onnx_runtime(a.at(0), shape, windows),
                   difference_from_degrees(a.at(0), shape, windows));
      }
}

int run(std::string_view command, const Arguments& arguments) {
  if (command == "seeded-model") return write_seeded_model(arguments), 0;
  if (command == "weights") return write_weights(arguments), 0;
  if (command == "outputs") return write_outputs(arguments), 0;
  if (command == "training") return write_training(arguments), 0;
  if (command == "onnx-runtime") return compare_onnx_runtime(arguments), 0;
  fmt::print(stderr, "unknown command '{}'\n", command);
  return 2;
}

}  // namespace

int main(int count, char** arguments) try {
  if (count < 2) return run("", {});
  return run(arguments[1], Arguments(arguments + 2, arguments + count));
} catch (const thermorig::Error& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
} catch (const std::exception& error) {
  fmt::print(stderr, "arguments: {}\n", error.what());
  return 2;
}
