// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/rig/recording/virtual_recording.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::rig::test {

/// A simulated rig as a bus, with wires that a test can cut or damage.
class SimulatedBus : public DeviceBus {
 public:
  using Damage = std::function<std::vector<std::uint8_t>(std::vector<std::uint8_t> bytes, HostTime now)>;

  explicit SimulatedBus(const simulation::VirtualRigConfig& config,
                        std::unique_ptr<simulation::Firmware> firmware = simulation::make_host_firmware());
  void send(Device to, std::span<const std::uint8_t> bytes, HostTime now) override;
  std::vector<Chunk> advance(HostTime until) override;
  std::vector<PortChange> take_changes() override;

  Damage to_servo;                               // what becomes of bytes to the servo
  std::function<bool(Device, HostTime)> is_cut;  // chunks that never arrive
  std::vector<simulation::Outage> unplugged;     // neither way, and the port hangs up
  Damage from_device[3];                         // what becomes of bytes of each device
  simulation::VirtualRig rig;

 private:
  bool is_unplugged(Device device, HostTime time) const;
  HostTime now_{};
  PerDevice<bool> was_unplugged_{};
};

/// A folder of its own for each test, gone afterwards.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Two short pairs of legs on the default rig, without a quota.
SweepPlan short_plan();

RecordingOptions recording_options(const std::filesystem::path& folder, const RigProfile& profile,
                                   const SweepPlan& plan);
RecordingOptions recording_options(const TemporaryFolder& folder, const RigProfile& profile,
                                   const SweepPlan& plan);

/// A whole recording in virtual time up to the closed journal, which is left there.
struct DrivenRun {
  SessionFile file;
  RawRecording raw;
  std::optional<Error> failure;
  bool stopped = false;
  HostTime end{};
};
struct RunOptions {
  std::optional<double> stop_at_s;     // Ctrl-C
  std::optional<double> give_up_at_s;  // kill -9: the journal is left as it is
  std::function<void(Recording&, HostTime)> each_step;
};
DrivenRun run_to_journal(SimulatedBus& bus, const RecordingOptions& options,
                         const RunOptions& run_options = {});

/// Frames of each leg, by their labels.
std::vector<int> frames_by_leg(const RawRecording& raw);

}  // namespace thermorig::rig::test
