// SPDX-License-Identifier: MIT
// Session after session in virtual time, with faults at seeded moments. THERMORIG_SOAK_HOURS: hours of
// virtual time (default: some minutes, for every run of the tests); tests/bench/soak.sh sets it.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <random>

#include "rig/simulated_bus.h"
#include "thermorig/core/error.h"

namespace thermorig::rig::test {
namespace {

constexpr double default_hours = 0.1;
constexpr double report_every_h = 6.0;

/// What goes wrong. `half`: every other chunk is lost. `commands`: those to the servo, whose watchdog then
/// trips.
enum class Kind : std::uint8_t { silent, garbage, bits, commands, half, unplugged };
constexpr std::uint64_t kinds = 6;

struct Process {
  double memory_mb = 0.0;
  std::size_t handles = 0;
};

Process this_process() {
  Process process;
  std::size_t total = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  process.memory_mb = 1e-6 * static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE));
  const std::filesystem::directory_iterator handles("/proc/self/fd");
  process.handles = static_cast<std::size_t>(std::distance(begin(handles), end(handles))) - 1;  // its own
  return process;
}

/// One fault: what, which device, when.
struct Fault {
  Kind kind = Kind::silent;
  Device device = Device::camera;
  HostTime begin{};
  HostTime end{};
  bool holds(HostTime now) const { return begin <= now && now < end; }
};

class Faults {
 public:
  Faults(std::mt19937_64& random, double span_s) {
    std::uniform_real_distribution<double> when(0.5, span_s);
    for (int i = 0; i < 4; ++i) {
      Fault fault{.kind = static_cast<Kind>(random() % kinds),
                  .device = all_devices[random() % device_count],
                  .begin = HostTime{} + from_s(when(random))};
      const auto share = static_cast<double>(random() % 100) / 100.0;
      // A plug that is out for more than 20 s is out for longer than the recording waits.
      fault.end =
          fault.begin + from_s(fault.kind == Kind::unplugged ? 1.0 + 25.0 * share : 0.2 + 2.0 * share);
      list.push_back(fault);
    }
  }

  void put_into(SimulatedBus& bus, std::uint64_t seed) const {
    const auto shared = std::make_shared<std::mt19937_64>(seed);
    for (const Fault& fault : list)
      if (fault.kind == Kind::unplugged) bus.unplugged.push_back({fault.device, fault.begin, fault.end});
    for (const Device device : all_devices)
      bus.from_device[index_of(device)] = [faults = *this, device, shared](std::vector<std::uint8_t> bytes,
                                                                           HostTime now) {
        for (const Fault& fault : faults.list)
          if (fault.device == device && fault.holds(now)) damage(fault.kind, bytes, *shared);
        return bytes;
      };
    bus.to_servo = [faults = *this](std::vector<std::uint8_t> bytes, HostTime now) {
      for (const Fault& fault : faults.list)
        if (fault.kind == Kind::commands && fault.holds(now)) bytes.clear();
      return bytes;
    };
  }

  std::vector<Fault> list;

 private:
  static void damage(Kind kind, std::vector<std::uint8_t>& bytes, std::mt19937_64& random) {
    if (bytes.empty()) return;
    if (kind == Kind::silent || (kind == Kind::half && random() % 2 == 0)) bytes.clear();
    if (kind == Kind::garbage)
      for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    if (kind == Kind::bits) bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1U << (random() % 8));
  }
};

/// Counts what reached the recording.
class CountingBus : public DeviceBus {
 public:
  explicit CountingBus(SimulatedBus& bus) : bus_(bus) {}
  void send(Device to, std::span<const std::uint8_t> sent, HostTime now) override {
    bus_.send(to, sent, now);
  }
  std::vector<Chunk> advance(HostTime until) override {
    auto chunks = bus_.advance(until);
    for (const Chunk& chunk : chunks) bytes[chunk.device] += chunk.bytes.size();
    return chunks;
  }
  std::vector<PortChange> take_changes() override { return bus_.take_changes(); }
  PerDevice<std::uint64_t> bytes{};

 private:
  SimulatedBus& bus_;
};

/// All that was delivered is in the file, each frame has its sample, and the quality can be said.
void check_session(const std::filesystem::path& file, const PerDevice<std::uint64_t>& delivered) {
  const session::Session session = session::read_session(file);
  for (const Device device : all_devices)
    EXPECT_EQ(session.raw.received[device].bytes.size(), delivered[device]) << name_of(device);
  EXPECT_EQ(session.samples.size(), session.frames.size());
  EXPECT_FALSE(session::quality_of(session).verdict.empty());
}

struct Tally {
  int sessions = 0, complete = 0, lost = 0, refused = 0, other = 0;
  double virtual_s = 0.0;
  std::uint64_t frames = 0, valid = 0;
};

/// One session, kept, checked and removed.
void record_one(std::uint64_t seed, Tally& tally) {
  std::mt19937_64 random(seed);
  PlanOverrides overrides;
  overrides.valid_per_leg = 0;
  overrides.seed = seed;
  const SweepPlan plan = load_plan("quick", "garden", seed, overrides);
  const simulation::VirtualRigConfig config = simulation::default_rig(seed, "garden");
  SimulatedBus bus(config);
  Faults(random, 30.0).put_into(bus, seed);
  CountingBus counted(bus);
  const TemporaryFolder folder;
  VirtualOptions options;
  options.recording = recording_options(folder, config.profile, plan);
  options.recording.preflight = PreflightMode::refuse;
  options.recording.replug_patience_s = 20.0;
  HostTime last{};
  options.progress = [&](const RecordingProgress& progress) { last = progress.time; };
  ++tally.sessions;
  try {
    const RecordingResult result = record_virtual(counted, options);
    check_session(result.session, counted.bytes);
    tally.frames += result.quality.frames;
    tally.valid += result.quality.valid;
    if (result.exit == ExitCode::ok || result.exit == ExitCode::finished_lossy)
      ++tally.complete;
    else if (result.exit == ExitCode::device_lost)
      ++tally.lost;
    else
      ++tally.other;
  } catch (const Error& error) {
    ++tally.refused;  // before anything moved: then there must be no file
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << error.what();
  }
  tally.virtual_s += to_s(last - HostTime{});
}

void report(const Tally& tally) {
  const Process process = this_process();
  fmt::print(
      "{:6.2f} h  {} sessions: {} complete, {} with a device lost, {} refused; {:.1f} MB, {} handles\n",
      tally.virtual_s / 3600.0, tally.sessions, tally.complete, tally.lost, tally.refused, process.memory_mb,
      process.handles);
  std::fflush(stdout);
}

TEST(Soak, HoursOfSessionsWithFaultsKeepMemoryAndHandlesFlat) {
  const char* said = std::getenv("THERMORIG_SOAK_HOURS");
  const double hours = said == nullptr ? default_hours : std::atof(said);
  constexpr int warm_up = 4;  // sessions, until every pool has been filled once
  Tally tally;
  std::uint64_t seed = 1;
  while (tally.sessions < warm_up) record_one(seed++, tally);
  const Process before = this_process();
  report(tally);
  double next_h = report_every_h;
  while (tally.virtual_s < 3600.0 * hours && !HasFailure()) {
    record_one(seed++, tally);
    if (tally.virtual_s < 3600.0 * next_h) continue;
    report(tally);
    next_h += report_every_h;
  }
  const Process after = this_process();
  report(tally);
  EXPECT_EQ(after.handles, before.handles);
  EXPECT_LT(after.memory_mb, 1.3 * before.memory_mb + 16.0);
  EXPECT_GT(tally.complete, tally.sessions / 4);
  fmt::print(
      "{{\"virtual_hours\": {:.3f}, \"sessions\": {}, \"complete\": {}, \"device_lost\": {}, \"refused\": "
      "{}, "
      "\"frames\": {}, \"memory_mb_before\": {:.1f}, \"memory_mb_after\": {:.1f}, \"handles_before\": {}, "
      "\"handles_after\": {}}}\n",
      tally.virtual_s / 3600.0, tally.sessions, tally.complete, tally.lost, tally.refused, tally.frames,
      before.memory_mb, after.memory_mb, before.handles, after.handles);
}

}  // namespace
}  // namespace thermorig::rig::test
