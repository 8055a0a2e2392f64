// SPDX-License-Identifier: MIT
// How fast bytes become labelled samples and a finished session. THERMORIG_BENCH_SESSION names the session
// whose raw bytes are used.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "thermorig/pipeline/pipeline.h"
#include "thermorig/rig/recording/finalise.h"
#include "thermorig/storage/session/session.h"

namespace {

using namespace thermorig;

const RawRecording& recording() {
  static const RawRecording raw = [] {
    const char* path = std::getenv("THERMORIG_BENCH_SESSION");
    if (path == nullptr) throw std::runtime_error("set THERMORIG_BENCH_SESSION to a session file");
    return session::read_raw(path);
  }();
  return raw;
}

PerDevice<std::uint64_t> byte_counts(const RawRecording& raw) {
  PerDevice<std::uint64_t> counts;
  for (const Device device : all_devices) counts[device] = raw.received[device].bytes.size();
  return counts;
}

std::int64_t byte_count(const RawRecording& raw) {
  const auto counts = byte_counts(raw).values;
  return static_cast<std::int64_t>(std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}));
}

struct ChunkReference {
  Device device;
  std::size_t index;
  HostTime arrived;
};

std::vector<ChunkReference> chunks_by_arrival(const RawRecording& raw) {
  std::vector<ChunkReference> chunks;
  for (const Device device : all_devices)
    for (std::size_t i = 0; i < raw.received[device].chunk_count(); ++i)
      chunks.push_back({device, i, raw.received[device].time(i)});
  std::stable_sort(chunks.begin(), chunks.end(),
                   [](const ChunkReference& a, const ChunkReference& b) { return a.arrived < b.arrived; });
  return chunks;
}

void BytesToLabelledSamples(benchmark::State& state) {
  const RawRecording& raw = recording();
  const std::vector<ChunkReference> chunks = chunks_by_arrival(raw);
  const PerDevice<std::uint64_t> bytes = byte_counts(raw);
  std::size_t samples = 0;
  for ([[maybe_unused]] const auto iteration : state) {
    samples = 0;
    pipeline::Pipeline pipeline(raw.header.profile);
    pipeline.expect(bytes);
    for (const ChunkReference& chunk : chunks)
      samples +=
          pipeline.feed(chunk.device, raw.received[chunk.device].chunk(chunk.index), chunk.arrived).size();
    samples += pipeline.finish().size();
    benchmark::DoNotOptimize(pipeline.take_streams());
  }
  state.SetBytesProcessed(byte_count(raw) * state.iterations());
  state.counters["samples"] = static_cast<double>(samples);
}
BENCHMARK(BytesToLabelledSamples)->Unit(benchmark::kMillisecond)->UseRealTime();

void BytesToFinishedSession(benchmark::State& state) {
  const std::filesystem::path path =
      std::filesystem::path(std::getenv("THERMORIG_BENCH_SESSION")).replace_extension(".bench.h5");
  for ([[maybe_unused]] const auto iteration : state) {
    state.PauseTiming();
    RawRecording raw = recording();
    std::filesystem::remove(path);
    state.ResumeTiming();
    session::write_session(path, rig::build_session(std::move(raw)));
  }
  std::filesystem::remove(path);
  state.SetBytesProcessed(byte_count(recording()) * state.iterations());
}
BENCHMARK(BytesToFinishedSession)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
