// SPDX-License-Identifier: MIT
// The paths of costs.sh, each once, on one simulated recording and on one thread. Callgrind counts within a
// path alone, and dumps its count under the path's name. THERMORIG_COSTS_FOLDER: where a journal may be
// written.
#include <sys/wait.h>
#include <unistd.h>
#include <valgrind/callgrind.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "interop/seeded_values.h"
#include "live/live_messages.h"
#include "storage/session/session_image.h"
#include "thermorig/estimators/live/live_estimates.h"
#include "thermorig/estimators/live/scores.h"
#include "thermorig/fit/fit.h"
#include "thermorig/network/trainer.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/pipeline/replay.h"
#include "thermorig/rig/recording/finalise.h"
#include "thermorig/storage/journal/journal.h"
#include "timing_rig.h"

namespace thermorig::bench {
namespace {

/// In a child process: callgrind counts rightly where it begins to count once.
void count(const std::string& name, const std::function<void()>& path) {
  const pid_t child = ::fork();
  if (child == 0) {
    CALLGRIND_START_INSTRUMENTATION;
    path();
    CALLGRIND_DUMP_STATS_AT(name.c_str());
    ::_exit(0);
  }
  int status = 0;
  if (child < 0 || ::waitpid(child, &status, 0) != child || status != 0)
    throw std::runtime_error(name + " failed");
}

/// A minute, in which the rig goes round to either side.
RawRecording recording() {
  std::vector<Leg> legs;
  for (int i = 0; i < 3; ++i)
    legs.push_back({10.0 + 20.0 * i, 16.0, (i % 2 == 0 ? 1.0 : -1.0) * (30.0 + 20.0 * i)});
  RawRecording raw = record(rig_in_world(5, "kitchen"), legs, 70.0).raw;
  raw.header.uuid = "8d3f2a10-7f6e-4c55-9d0a-2b1c3d4e5f60";
  raw.header.environment = "kitchen";
  raw.header.title = "kitchen, acquisition 1";
  raw.header.start_time_utc = "2026-07-25T14:35:59.900001Z";
  return raw;
}

pipeline::Streams messages_of(const RawRecording& raw) {
  pipeline::Pipeline first_pass(raw.header.profile, {}, true);
  Replay replay(raw);
  while (const auto step = replay.next()) pipeline::feed(first_pass, *step);
  first_pass.finish();
  return first_pass.take_streams();
}

std::vector<Measurement> measurements_of(const RawRecording& raw) {
  std::vector<Measurement> measurements;
  pipeline::Pipeline pipeline(raw.header.profile);
  Replay replay(raw);
  const auto take = [&](std::vector<Measurement> more) {
    for (Measurement& measurement : more) measurements.push_back(std::move(measurement));
  };
  while (const auto step = replay.next()) take(pipeline::feed(pipeline, *step));
  take(pipeline.finish());
  return measurements;
}

void count_session(const RawRecording& raw) {
  count("bytes_to_labels", [&] { measurements_of(raw); });
  count("bytes_to_messages", [&] { messages_of(raw); });
  const pipeline::Streams streams = messages_of(raw);
  count("fits", [&] { fit::fit_recording(raw, streams); });
  const session::Session session = rig::build_session(raw);
  count("session_to_file_image", [&] { session::build_image(session, 1); });
}

void count_journal(const RawRecording& raw, const std::filesystem::path& path) {
  journal::JournalWriter journal(path, raw.header, 1U << 20U);
  const RawStream& camera = raw.received[Device::camera];
  count("journal_appends", [&] {
    for (std::size_t i = 0; i < camera.chunk_count(); ++i)
      journal.received(Device::camera, camera.chunk(i), camera.time(i));
  });
}

void count_estimators(const RigProfile& profile, const std::vector<Measurement>& measurements) {
  for (const std::string& name : estimators::names_for(std::nullopt)) {
    estimators::Bank bank(std::vector{name}, std::nullopt, profile);
    count("estimator_" + name, [&] {
      for (const Measurement& measurement : measurements) bank.add(measurement);
    });
  }
}

void count_page(const RigProfile& profile, const std::vector<Measurement>& measurements) {
  const std::vector<std::string> names{"gyro", "gyro-rest"};
  live::LiveEstimates estimates(estimators::Bank(names, std::nullopt, profile));
  const std::vector<EstimatorColumn> columns = live::columns_of(estimates.bank());
  live::Scorer scorer(columns);
  std::vector<EstimateRow> rows;
  for (const Measurement& measurement : measurements) {
    rows.push_back(estimates.add(measurement, measurement.frame.exposure_end));
    scorer.add(rows.back());
  }
  const live::LiveScores scores = scorer.scores();
  count("page_messages", [&] {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const app::LiveFrame frame{measurements[i].frame, measurements[i].sample, columns, rows[i], scores};
      app::frame_message(frame, bench_start()).dump();
      app::image_message(frame, bench_start(), false).dump();
    }
  });
}

/// With the kernels that every machine with AVX2 has: Valgrind knows none beyond.
void count_network() {
  using namespace network;
  const auto sets = instruction_sets();
  const bool has_avx2 = std::ranges::find(sets, InstructionSet::avx2) != sets.end();
  const InstructionSet set = has_avx2 ? InstructionSet::avx2 : InstructionSet::baseline;
  const Weights weights = interop::seeded_weights({.frames = 3, .reduction = 1}, 1);
  const interop::SeededBatch windows(weights.shape, 1, 0, 32);
  const Batch batch = windows.batch();
  Estimator estimator(weights, Precision::fp32, set);
  CallingThread workers;
  TrainerConfig config;
  config.set = set;
  Trainer trainer(weights, config, workers);
  count("inferences", [&] {
    for (std::size_t i = 0; i < batch.gyro.size(); ++i)
      estimator.estimate({batch.frames[i], weights.shape.inputs()}, batch.gyro[i]);
  });
  count("training_step", [&] { trainer.step(batch); });
}

void count_all(const std::filesystem::path& folder) {
  const RawRecording raw = recording();
  count_session(raw);
  count_journal(raw, folder / "costs.journal");
  const std::vector<Measurement> measurements = measurements_of(raw);
  count_estimators(raw.header.profile, measurements);
  count_page(raw.header.profile, measurements);
  count_network();
}

}  // namespace
}  // namespace thermorig::bench

int main() {
  const char* const folder = std::getenv("THERMORIG_COSTS_FOLDER");
  if (folder == nullptr) return 2;
  thermorig::bench::count_all(folder);
  return 0;
}
