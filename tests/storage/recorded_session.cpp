// SPDX-License-Identifier: MIT
#include "recorded_session.h"

#include <algorithm>

#include "rig/simulated_bus.h"
#include "thermorig/core/error.h"
#include "thermorig/rig/recording/finalise.h"
#include "thermorig/storage/journal/journal.h"

namespace thermorig::storage_test {

namespace {

constexpr auto step = std::chrono::milliseconds(4);

rig::RecordingOptions options_for(int frames) {
  rig::PlanOverrides overrides;
  overrides.magnitudes_dps = {60.0, 120.0};
  overrides.frames_per_leg = (frames - 8) / 4;  // four legs; the others are rests and ramps
  overrides.valid_per_leg = 0;
  overrides.opening_rest_s = 0.5;
  overrides.closing_rest_s = 0.5;
  rig::RecordingOptions options;
  options.environment = "kitchen";
  options.output = output_folder;
  options.profile = simulation::default_profile();
  options.plan = rig::load_plan("quick", "kitchen", 1, overrides);
  options.simulated = true;
  options.simulation = "virtual time, firmware's host build";
  options.creator = "thermorig storage test";
  options.virtual_time = true;
  return options;
}

}  // namespace

std::size_t RecordedSession::taken(Device device, std::size_t made) const {
  const auto& at = received[device].calls;
  return static_cast<std::size_t>(std::upper_bound(at.begin(), at.end(), made) - at.begin());
}

std::size_t RecordedSession::arrived(Device device, HostTime by) const {
  const auto& at = received[device].chunks.time_ns;
  return static_cast<std::size_t>(std::upper_bound(at.begin(), at.end(), to_ns(by)) - at.begin());
}

MemoryDisk new_disk(std::uint64_t capacity) {
  return MemoryDisk({.files = {}, .folders = {"/"}}, capacity);
}

RecordedSession record_session(int frames) {
  RecordedSession session;
  session.options = options_for(frames);
  MemoryDisk memory = new_disk();
  FaultDisk disk(memory);
  HostTime now{};
  disk.keep_calls(&now);
  rig::test::SimulatedBus bus(simulation::default_rig(1, "kitchen"));
  rig::RecordingOptions options = session.options;
  options.disk = &disk;
  rig::Recording recording(options, now, [&](Device to, std::span<const std::uint8_t> bytes) {
    session.sent[to].chunks.append(bytes, now);
    session.sent[to].calls.push_back(disk.count());
    bus.send(to, bytes, now);
  });
  while (!recording.done()) {
    now += step;
    session.steps.push_back({now, bus.advance(now)});
    for (const Chunk& chunk : session.steps.back().chunks) {
      recording.received(chunk.device, chunk.bytes, chunk.arrived);
      session.received[chunk.device].chunks.append(chunk.bytes, chunk.arrived);
      session.received[chunk.device].calls.push_back(disk.count());
    }
    recording.tick(now);
  }
  MemoryDisk copy(memory.after_end());  // a read of its own would shift the numbers of later files
  session.raw = journal::read_journal(recording.file().journal, copy).recording;
  const rig::RecordingResult result = rig::conclude(recording, now);
  session.concluded = disk.count();
  session.calls = disk.calls();
  session.frames = result.quality.frames;
  return session;
}

RecordedAgain record_again(const RecordedSession& session, files::Disk& disk, HostTime* clock) {
  RecordedAgain again;
  *clock = HostTime{};
  rig::RecordingOptions options = session.options;
  options.disk = &disk;
  try {
    rig::Recording recording(options, *clock, [](Device, std::span<const std::uint8_t>) {});
    for (const RecordedSession::Step& at : session.steps) {
      *clock = at.now;
      for (const Chunk& chunk : at.chunks) {
        recording.received(chunk.device, chunk.bytes, chunk.arrived);
        ++again.taken[chunk.device];
      }
      recording.tick(at.now);
      ++again.steps;
    }
    rig::conclude(recording, *clock);
    again.announced = true;
  } catch (const Error& error) {
    again.error = error.what();
    again.code = error.code();
  }
  again.end = *clock;
  return again;
}

}  // namespace thermorig::storage_test
