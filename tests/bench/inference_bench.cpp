// SPDX-License-Identifier: MIT
// Inference of one window, layer by layer: convolutions as a fraction of what the machine's multiply-add
// units could do at best, the big fully connected layers as a fraction of what it can read of their weights,
// both measured in turn with them. Layers are timed inside whole inferences, so that the caches hold what
// they hold there. Processor time of one thread, warm.
//
//   inference_bench --benchmark_filter='AVX-512/Nf=3/Nr=1/fusion/fp32'
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "../network/random_windows.h"
#include "multiply_add_peak.h"
#include "network/inference_network.h"
#include "read_bandwidth.h"

namespace {

using namespace thermorig::network;

constexpr int windows = 8;

double processor_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

constexpr std::array layer_names = {"load", "conv1", "conv2", "list", "dense1", "heads"};

struct Layer {
  std::function<void(std::size_t window)> run;
  std::function<double()> multiply_adds;
  std::function<double()> bytes;  // of weights that are read from beyond the first cache
};

/// An estimator taken apart.
class Inference {
 public:
  Inference(const Shape& shape, Precision precision, InstructionSet set)
      : network_(initial_weights(shape, 1), precision, set), windows_(shape, windows, 1) {
    const double taps = kernel_size * kernel_size;
    const double conv1 = shape.rows1() * shape.columns1() * filters1 * shape.frames * taps;
    const double conv2 = shape.rows2() * shape.columns2() * filters2 * filters1 * taps;
    const double outputs = (shape.fusion ? 2.0 : 1.0) * hidden1;
    const auto none = [] { return 0.0; };
    layers_ = {
        {[this](std::size_t w) { network_.load(windows_.frames[w]); }, none, none},
        {[this](std::size_t) { network_.convolve1(); }, [=] { return conv1; }, none},
        {[this](std::size_t) { network_.convolve2(); }, [=] { return conv2; }, none},
        {[this](std::size_t) { network_.list_features(); }, none, none},
        {[this](std::size_t) { network_.dense1(); },
         [this, outputs] { return outputs * network_.listed_features(); },
         [this] { return 1.0 * network_.listed_features() * network_.bytes_per_feature(); }},
        {[this](std::size_t w) { benchmark::DoNotOptimize(network_.heads(windows_.gyro[w])); }, none, none},
    };
  }
  Inference(const Inference&) = delete;

  const std::vector<Layer>& layers() const { return layers_; }
  const InferenceNetwork& network() const { return network_; }

 private:
  InferenceNetwork network_;
  RandomWindows windows_;
  std::vector<Layer> layers_;  // as in layer_names
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Operations a microsecond and bytes a microsecond that the machine can do now.
struct Bounds {
  double operations, bytes;
};

Bounds bounds_of(InstructionSet set, const std::vector<float>& weights) {
  std::vector<double> operations, bytes;
  for (int i = 0; i < 15; ++i) {
    double begin = processor_us();
    const double burst = multiply_add_burst(set);
    operations.push_back(burst / (processor_us() - begin));
    begin = processor_us();
    read_burst(weights);
    bytes.push_back(static_cast<double>(weights.size() * sizeof(float)) / (processor_us() - begin));
  }
  return {median(operations), median(bytes)};
}

/// Weights as many as the layer has, to read.
std::vector<float> weights_like(const Inference& inference) {
  const std::size_t bytes = static_cast<std::size_t>(inference.network().shape().features()) *
                            static_cast<std::size_t>(inference.network().bytes_per_feature());
  return std::vector<float>((bytes / sizeof(float) + 511) / 512 * 512);
}

/// What looking at the clock twice takes, which is not little beside these layers.
double clock_us() {
  std::vector<double> times;
  for (int i = 0; i < 101; ++i) {
    const double begin = processor_us();
    times.push_back(processor_us() - begin);
  }
  return median(times);
}

/// One layer, timed amid whole inferences; the clock's time is taken off.
void measure_layer(benchmark::State& state, const Shape& shape, Precision precision, InstructionSet set,
                   std::size_t chosen) {
  Inference inference(shape, precision, set);
  const Layer& layer = inference.layers()[chosen];
  const Bounds bounds = bounds_of(set, weights_like(inference));
  const double clock = clock_us();
  std::vector<double> times;
  double operations = 0.0, bytes = 0.0;
  std::size_t window = 0;
  for (auto _ : state) {
    double taken = 0.0;
    for (std::size_t i = 0; i < inference.layers().size(); ++i) {
      const double begin = i == chosen ? processor_us() : 0.0;
      inference.layers()[i].run(window % windows);
      if (i == chosen) taken = std::max(processor_us() - begin - clock, 0.0);
    }
    state.SetIterationTime(1e-6 * taken);
    times.push_back(taken);
    operations += 2.0 * layer.multiply_adds();
    bytes += layer.bytes();
    ++window;
  }
  const auto count = static_cast<double>(times.size());
  state.counters["median_us"] = median(times);
  state.counters["best_us"] = *std::min_element(times.begin(), times.end());
  if (operations > 0.0) state.counters["of_peak"] = operations / count / median(times) / bounds.operations;
  if (bytes > 0.0) {
    state.counters["of_bandwidth"] = bytes / count / median(times) / bounds.bytes;
    state.counters["bandwidth_GBps"] = 1e-3 * bounds.bytes;
    state.counters["listed"] = bytes / count / inference.network().bytes_per_feature() / shape.features();
  }
}

/// Whole inferences, ten between two looks at the clock.
void measure_whole(benchmark::State& state, const Shape& shape, Precision precision, InstructionSet set) {
  Estimator estimator(initial_weights(shape, 1), precision, set);
  const RandomWindows input(shape, windows, 1);
  std::vector<double> times;
  for (auto _ : state) {
    const double begin = processor_us();
    for (std::size_t i = 0; i < 10; ++i)
      benchmark::DoNotOptimize(estimator.estimate(input.frames[i % windows], input.gyro[i % windows]));
    times.push_back((processor_us() - begin) / 10.0);
    state.SetIterationTime(1e-6 * times.back());
  }
  state.counters["median_us"] = median(times);
  state.counters["best_us"] = *std::min_element(times.begin(), times.end());
}

void add_benchmarks(const Shape& shape, Precision precision, InstructionSet set) {
  const std::string setting =
      fmt::format("{}/Nf={}/Nr={}/{}/{}/", name_of(set), shape.frames, shape.reduction,
                  shape.fusion ? "fusion" : "thermal", precision == Precision::fp32 ? "fp32" : "fp16");
  const auto add = [&](const std::string& name, auto... measure) {
    benchmark::RegisterBenchmark((setting + name).c_str(), measure...)
        ->UseManualTime()
        ->Iterations(500)
        ->Unit(benchmark::kMicrosecond);
  };
  for (std::size_t i = 0; i < layer_names.size(); ++i)
    add(layer_names[i], measure_layer, shape, precision, set, i);
  add("inference", measure_whole, shape, precision, set);
}

}  // namespace

int main(int argc, char** argv) {
  for (InstructionSet set : instruction_sets())
    for (Precision precision : {Precision::fp32, Precision::fp16_weights})
      for (bool fusion : {true, false}) {
        for (int reduction = min_reduction; reduction <= max_reduction; ++reduction)
          add_benchmarks({.frames = 3, .reduction = reduction, .fusion = fusion}, precision, set);
        for (int frames : {2, 4, 5, 6}) add_benchmarks({.frames = frames, .fusion = fusion}, precision, set);
      }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
