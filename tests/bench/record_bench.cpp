// SPDX-License-Identifier: MIT
// How fast bytes become labelled samples and a finished session; processor time is that of all threads.
// THERMORIG_BENCH_SESSION names the session whose raw bytes are used; THERMORIG_BENCH_CHUNKS its arrays in
// chunks, as they are compressed: the size of each (64 bits) before its bytes.
#include <benchmark/benchmark.h>
#include <libdeflate.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "storage/session/session_image.h"
#include "thermorig/core/run_all.h"
#include "thermorig/fit/fit.h"
#include "thermorig/fit/motion/panorama_fit.h"
#include "thermorig/fit/shaft/gyro_errors.h"
#include "thermorig/fit/shaft/servo_response.h"
#include "thermorig/io/files/part_file.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/pipeline/replay.h"
#include "thermorig/rig/recording/finalise.h"
#include "thermorig/storage/session/session.h"

namespace {

using namespace thermorig;

std::filesystem::path path_in(const char* variable) {
  const char* path = std::getenv(variable);
  if (path == nullptr) throw std::runtime_error(std::string("set ") + variable + " to a file");
  return path;
}

const RawRecording& recording() {
  static const RawRecording raw = session::read_raw(path_in("THERMORIG_BENCH_SESSION"));
  return raw;
}

std::vector<std::vector<char>> chunks_to_compress() {
  std::ifstream file(path_in("THERMORIG_BENCH_CHUNKS"), std::ios::binary);
  std::vector<std::vector<char>> chunks;
  std::uint64_t size = 0;
  while (file.read(reinterpret_cast<char*>(&size), sizeof size))
    file.read(chunks.emplace_back(size).data(), static_cast<std::streamsize>(size));
  return chunks;
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
BENCHMARK(BytesToLabelledSamples)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

pipeline::Streams causal_streams(const RawRecording& raw) {
  pipeline::Pipeline first_pass(raw.header.profile, {}, true);
  first_pass.expect(byte_counts(raw));
  Replay replay(raw);
  while (const auto step = replay.next()) pipeline::feed(first_pass, *step);
  first_pass.finish();
  return first_pass.take_streams();
}

void BytesToMessages(benchmark::State& state) {
  for ([[maybe_unused]] const auto iteration : state) benchmark::DoNotOptimize(causal_streams(recording()));
}
BENCHMARK(BytesToMessages)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

/// What a session knows and the peer's does not: clocks with bounds, gyro, camera offset, servo.
void FitsOfSession(benchmark::State& state) {
  const RawRecording& raw = recording();
  const pipeline::Streams streams = causal_streams(raw);
  for ([[maybe_unused]] const auto iteration : state) {
    state.PauseTiming();
    pipeline::Streams copy = streams;
    state.ResumeTiming();
    benchmark::DoNotOptimize(fit::fit_recording(raw, std::move(copy), on_all_cores));
  }
}
BENCHMARK(FitsOfSession)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

/// A finished session, for its fits one by one: what they rest on is known to the gyro's errors.
struct Finished {
  session::Session session = rig::build_session(recording());
  const RigProfile& profile = session.raw.header.profile;
  motion::View view{profile.camera.lens_width_deg(), profile.camera.mirrored};
  GyroErrors errors = fit::fit_gyro_errors(session.gyro, session.servo, profile.gyro);

  ServoResponse fit_servo() {
    return fit::fit_servo_response(session.servo, session.gyro, errors, profile.servo);
  }
};

Finished& finished() {
  static Finished one;
  return one;
}

void ServoOfSession(benchmark::State& state) {
  Finished& of = finished();
  for ([[maybe_unused]] const auto iteration : state) benchmark::DoNotOptimize(of.fit_servo());
}
BENCHMARK(ServoOfSession)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

void TurnsOfSession(benchmark::State& state) {
  Finished& of = finished();
  of.fit_servo();
  for ([[maybe_unused]] const auto iteration : state)
    benchmark::DoNotOptimize(motion::gyro_scale(of.session.frames, of.session.gyro, of.view, of.errors,
                                                motion::session_windows, on_all_cores));
}
BENCHMARK(TurnsOfSession)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

void CameraOffsetOfSession(benchmark::State& state) {
  Finished& of = finished();
  of.fit_servo();
  for ([[maybe_unused]] const auto iteration : state)
    benchmark::DoNotOptimize(
        motion::camera_offset(of.session.frames, of.session.gyro, of.view, of.errors, on_all_cores));
}
BENCHMARK(CameraOffsetOfSession)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

std::filesystem::path bench_path() {
  return path_in("THERMORIG_BENCH_SESSION").replace_extension(".bench.h5");
}

void BytesToFinishedSession(benchmark::State& state) {
  const std::filesystem::path path = bench_path();
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
BENCHMARK(BytesToFinishedSession)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

void SessionToFile(benchmark::State& state) {
  const session::Session& session = finished().session;
  const std::filesystem::path path = bench_path();
  for ([[maybe_unused]] const auto iteration : state) {
    state.PauseTiming();
    std::filesystem::remove(path);
    state.ResumeTiming();
    session::write_session(path, session);
  }
  std::filesystem::remove(path);
}
BENCHMARK(SessionToFile)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

/// The same file, synced, without a look at what the disk has of it: all that the peer does.
void SessionToFileUnread(benchmark::State& state) {
  const session::Session& session = finished().session;
  for ([[maybe_unused]] const auto iteration : state) {
    const session::SessionImage image =
        session::build_image(session, std::max(1U, std::thread::hardware_concurrency()));
    files::PartFile part(bench_path(), "the session");
    part.write(image.bytes);
    part.sync();
  }
}
BENCHMARK(SessionToFileUnread)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

/// What a session cannot do without: its arrays through the same library at the same level, on all cores.
void CompressingAlone(benchmark::State& state) {
  constexpr int level = 4;
  const auto chunks = chunks_to_compress();
  for ([[maybe_unused]] const auto iteration : state) {
    std::atomic<std::size_t> next = 0;
    const auto work = [&] {
      libdeflate_compressor* const compressor = libdeflate_alloc_compressor(level);
      std::vector<char> out;
      for (std::size_t i = next++; i < chunks.size(); i = next++) {
        out.resize(libdeflate_zlib_compress_bound(compressor, chunks[i].size()));
        benchmark::DoNotOptimize(
            libdeflate_zlib_compress(compressor, chunks[i].data(), chunks[i].size(), out.data(), out.size()));
      }
      libdeflate_free_compressor(compressor);
    };
    std::vector<std::jthread> threads;
    for (unsigned i = 0; i < std::max(1U, std::thread::hardware_concurrency()); ++i)
      threads.emplace_back(work);
  }
}
BENCHMARK(CompressingAlone)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
