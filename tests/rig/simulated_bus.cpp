// SPDX-License-Identifier: MIT
#include "simulated_bus.h"

#include <unistd.h>

#include <algorithm>
#include <utility>

#include "thermorig/rig/recording/finalise.h"
#include "thermorig/storage/journal/journal.h"

namespace thermorig::rig::test {

SimulatedBus::SimulatedBus(const simulation::VirtualRigConfig& config,
                           std::unique_ptr<simulation::Firmware> firmware)
    : rig(config, std::move(firmware)) {}

void SimulatedBus::send(Device to, std::span<const std::uint8_t> bytes, HostTime now) {
  std::vector<std::uint8_t> sent(bytes.begin(), bytes.end());
  if (to == Device::servo && to_servo) sent = to_servo(std::move(sent), now);
  if (is_unplugged(to, now)) return;
  if (!sent.empty()) rig.send(to, sent, now);
}

std::vector<Chunk> SimulatedBus::advance(HostTime until) {
  std::vector<Chunk> chunks = rig.advance(until);
  if (is_cut) std::erase_if(chunks, [&](const Chunk& chunk) { return is_cut(chunk.device, chunk.arrived); });
  std::erase_if(chunks, [&](const Chunk& chunk) { return is_unplugged(chunk.device, chunk.arrived); });
  for (Chunk& chunk : chunks)
    if (const Damage& damage = from_device[index_of(chunk.device)])
      chunk.bytes = damage(std::move(chunk.bytes), chunk.arrived);
  std::erase_if(chunks, [](const Chunk& chunk) { return chunk.bytes.empty(); });
  now_ = until;
  return chunks;
}

bool SimulatedBus::is_unplugged(Device device, HostTime time) const {
  return std::any_of(unplugged.begin(), unplugged.end(), [&](const simulation::Outage& outage) {
    return outage.device == device && outage.begin <= time && time < outage.end;
  });
}

std::vector<PortChange> SimulatedBus::take_changes() {
  std::vector<PortChange> changes;
  for (const Device device : all_devices) {
    const bool is_gone = is_unplugged(device, now_);
    if (is_gone != was_unplugged_[device]) changes.push_back({device, !is_gone});
    was_unplugged_[device] = is_gone;
  }
  return changes;
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "thermorig-rig-XXXXXX").string();
  path_ = mkdtemp(name.data());
}

TemporaryFolder::~TemporaryFolder() {
  std::filesystem::remove_all(path_);
}

SweepPlan short_plan() {
  PlanOverrides overrides;
  overrides.magnitudes_dps = {60.0, 120.0};
  overrides.frames_per_leg = 12;
  overrides.valid_per_leg = 0;
  overrides.opening_rest_s = 0.5;
  overrides.closing_rest_s = 0.5;
  return load_plan("quick", "kitchen", 1, overrides);
}

RecordingOptions recording_options(const TemporaryFolder& folder, const RigProfile& profile,
                                   const SweepPlan& plan) {
  return recording_options(folder.path(), profile, plan);
}

RecordingOptions recording_options(const std::filesystem::path& folder, const RigProfile& profile,
                                   const SweepPlan& plan) {
  RecordingOptions options;
  options.environment = "kitchen";
  options.output = folder;
  options.profile = profile;
  options.plan = plan;
  options.simulated = true;
  options.simulation = "virtual time, firmware's host build";
  options.creator = "thermorig test";
  options.virtual_time = true;
  options.sync_period = HostDuration::zero();
  return options;
}

DrivenRun run_to_journal(SimulatedBus& bus, const RecordingOptions& options, const RunOptions& run_options) {
  HostTime now{};
  Recording recording(options, now,
                      [&](Device to, std::span<const std::uint8_t> bytes) { bus.send(to, bytes, now); });
  DrivenRun run;
  run.file = recording.file();
  while (!recording.done()) {
    now += std::chrono::milliseconds(4);
    for (const Chunk& chunk : bus.advance(now)) recording.received(chunk.device, chunk.bytes, chunk.arrived);
    if (run_options.give_up_at_s && to_s(now - HostTime{}) >= *run_options.give_up_at_s) return run;
    if (run_options.stop_at_s && to_s(now - HostTime{}) >= *run_options.stop_at_s)
      recording.request_stop(now);
    recording.tick(now);
    if (run_options.each_step) run_options.each_step(recording, now);
  }
  const RecordingOutcome outcome = recording.outcome(now);
  run.failure = outcome.failure;
  run.stopped = outcome.stopped_by.has_value();
  run.end = now;
  recording.close(now);
  run.raw = journal::read_journal(run.file.journal).recording;
  return run;
}

std::vector<int> frames_by_leg(const RawRecording& raw) {
  std::vector<int> frames;
  for (const LabelledSample& sample : build_session(raw).samples) {
    if (sample.leg >= frames.size()) frames.resize(sample.leg + 1U, 0);
    ++frames[sample.leg];
  }
  return frames;
}

}  // namespace thermorig::rig::test
