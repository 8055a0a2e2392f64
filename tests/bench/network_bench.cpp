// SPDX-License-Identifier: MIT
// A step of training, layer by layer, forward and backward, as a fraction of what the machine's multiply-add
// units could do at best, measured in turn with it. Layers are timed inside whole steps, so that the caches
// hold what they hold in training. Processor time of one thread.
//
//   network_bench --benchmark_filter='AVX-512/Nf=3/Nr=1/fusion'
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "multiply_add_peak.h"
#include "network/batch_gradients.h"
#include "network/denormals.h"

namespace {

using namespace thermorig::network;

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The multiply-adds, for one window, of the layers; Adam and the rest count as nothing.
struct Work {
  double conv1, conv2, dense1, heads;
  explicit Work(const Shape& shape) {
    const double window = taps * taps;
    conv1 = shape.rows1() * shape.columns1() * filters1 * shape.frames * window;
    conv2 = shape.rows2() * shape.columns2() * filters2 * filters1 * window;
    dense1 = shape.features() * hidden1 * (shape.fusion ? 2.0 : 1.0);
    heads = static_cast<double>(multiply_adds(shape)) - conv1 - conv2 - dense1;
  }
};

struct Phase {
  std::string name;
  double multiply_adds;  // a window
  std::function<void()> run;
};

/// A trainer taken apart.
class Step {
 public:
  Step(const Shape& shape, InstructionSet set)
      : network_(initial_weights(shape, 1), set), gradients_(network_) {
    std::mt19937 random(1);
    const auto draw = [&random] { return static_cast<float>(random()) / 2147483648.0F - 1.0F; };
    for (auto& window : windows_) {
      window.resize(shape.inputs());
      std::generate(window.begin(), window.end(), draw);
      frames_.push_back(window.data());
      gyro_.push_back(draw());
      label_.push_back(draw());
    }
    batch_ = {.frames = frames_, .gyro = gyro_, .label = label_, .mirrored = {}};
    add_phases(Work(shape));
  }
  Step(const Step&) = delete;

  std::span<const Phase> phases() const { return phases_; }

 private:
  void add_phases(const Work& work) {
    phases_ = {
        {"load", 0.0, [this] { network_.load(batch_, {}); }},
        {"conv1_forward", work.conv1, [this] { network_.convolve1({}); }},
        {"conv2_forward", work.conv2, [this] { network_.convolve2({}); }},
        {"dense1_forward", work.dense1, [this] { network_.dense1({}); }},
        {"heads_forward", work.heads, [this] { network_.heads(); }},
        {"heads_backward", 2.0 * work.heads,
         [this] {
           gradients_.begin(&adam_);
           gradients_.heads(batch_, {});
         }},
        {"dense1_backward", 2.0 * work.dense1, [this] { gradients_.dense1({}); }},
        {"conv2_backward_weights", work.conv2, [this] { gradients_.convolve2_weights({}); }},
        {"conv2_backward_input", work.conv2, [this] { gradients_.convolve2_input({}); }},
        {"conv1_backward", work.conv1, [this] { gradients_.convolve1({}); }},
        {"small_tensors", 0.0, [this] { gradients_.change_small_tensors(); }},
    };
  }

  BatchNetwork network_;
  BatchGradients gradients_;
  static constexpr AdamStep step{
      .root_scale = 0.25e12F, .divisor_least = 1e-2F, .one_minus_beta1 = 0.1F, .one_minus_beta2 = 0.001F};
  AdamSteps adam_{.others = step, .wide = step};
  std::array<std::vector<float>, max_batch> windows_;
  std::vector<const float*> frames_;
  std::vector<float> gyro_, label_;
  Batch batch_;
  std::vector<Phase> phases_;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

constexpr std::size_t whole_step = ~std::size_t{0};

/// How fast the multiply-add units are just now: operations per second.
double peak_now(InstructionSet set) {
  const double begin = processor_seconds();
  const double operations = multiply_add_burst(set);
  return operations / (processor_seconds() - begin);
}

/// Processor time of one phase, or of all. Only the chosen one lies between two looks at the clock.
double time_of(const Step& step, std::size_t chosen) {
  double begin = processor_seconds(), taken = 0.0;
  for (std::size_t i = 0; i < step.phases().size(); ++i) {
    if (i == chosen) begin = processor_seconds();
    step.phases()[i].run();
    if (i == chosen) taken = processor_seconds() - begin;
  }
  return chosen == whole_step ? processor_seconds() - begin : taken;
}

double work_of(const Step& step, std::size_t chosen) {
  double multiply_adds = 0.0;
  for (std::size_t i = 0; i < step.phases().size(); ++i)
    if (chosen == whole_step || chosen == i) multiply_adds += step.phases()[i].multiply_adds;
  return 2.0 * max_batch * multiply_adds;
}

/// Many steps, each between two bursts of multiply-adds; the median of the ratios, because a machine's clock
/// changes from one moment to the next.
void measure(benchmark::State& state, const Shape& shape, InstructionSet set, std::size_t chosen) {
  Step step(shape, set);
  const double operations = work_of(step, chosen);
  const FlushDenormals flush;
  std::vector<double> times, peaks, ratios;
  double before = peak_now(set);
  for (auto _ : state) {
    const double taken = time_of(step, chosen);
    state.SetIterationTime(taken);
    const double after = peak_now(set);
    times.push_back(taken);
    peaks.push_back(after);
    ratios.push_back(operations / taken / (0.5 * (before + after)));
    before = after;
  }
  state.counters["median_us"] = 1e6 * median(times);
  state.counters["best_us"] = 1e6 * *std::min_element(times.begin(), times.end());
  state.counters["peak_gflops"] = 1e-9 * median(peaks);
  state.counters["gflops"] = 1e-9 * operations / median(times);
  state.counters["of_peak"] = median(ratios);
}

void add_benchmarks(const Shape& shape, InstructionSet set) {
  const std::string setting = fmt::format("{}/Nf={}/Nr={}/{}/", name_of(set), shape.frames, shape.reduction,
                                          shape.fusion ? "fusion" : "thermal");
  const auto add = [&](const std::string& name, std::size_t phase) {
    benchmark::RegisterBenchmark((setting + name).c_str(), measure, shape, set, phase)
        ->UseManualTime()
        ->Iterations(200)
        ->Unit(benchmark::kMicrosecond);
  };
  const Step step(shape, set);
  for (std::size_t i = 0; i < step.phases().size(); ++i) add(step.phases()[i].name, i);
  add("step", whole_step);
}

}  // namespace

int main(int argc, char** argv) {
  for (InstructionSet set : instruction_sets()) {
    for (bool fusion : {true, false}) {
      for (int reduction = min_reduction; reduction <= max_reduction; ++reduction)
        add_benchmarks({.frames = 3, .reduction = reduction, .fusion = fusion}, set);
      for (int frames : {2, 4, 5, 6}) add_benchmarks({.frames = frames, .fusion = fusion}, set);
    }
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
