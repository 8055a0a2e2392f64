// SPDX-License-Identifier: MIT
// kill -9 at any write to the journal: what was read before it is in the session that recovery makes, but
// perhaps for the chunk that was being written. The recorder that is killed is a process of its own, in
// virtual time.
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <random>

#include "simulated_bus.h"
#include "thermorig/rig/recording/finalise.h"
#include "thermorig/rig/recording/port_recording.h"
#include "virtual_ports.h"
#include "watched_disk.h"

namespace thermorig::rig::test {
namespace {

/// What the ports gave the recorder; survives it.
struct Read {
  std::size_t bytes = 0;
  std::size_t last_bytes = 0;  // of the last chunk
};

/// Memory of this process and of those that it forks.
class SharedReads {
 public:
  SharedReads()
      : reads_(static_cast<PerDevice<Read>*>(mmap(nullptr, sizeof(PerDevice<Read>), PROT_READ | PROT_WRITE,
                                                  MAP_SHARED | MAP_ANONYMOUS, -1, 0))) {}
  ~SharedReads() { munmap(reads_, sizeof *reads_); }
  SharedReads(const SharedReads&) = delete;
  SharedReads& operator=(const SharedReads&) = delete;
  PerDevice<Read>& operator*() const { return *reads_; }

 private:
  PerDevice<Read>* reads_;
};

/// Ports that note what they give before the recorder sees it.
class NotedPorts : public VirtualPorts {
 public:
  NotedPorts(std::uint64_t seed, PerDevice<Read>& reads)
      : VirtualPorts(simulation::default_rig(seed, "kitchen")), reads_(reads) {}

  PortId open(const PortProfile& link, PortHandlers handlers, io::Refusal refusal) override {
    const auto device = std::find_if(all_devices.begin(), all_devices.end(),
                                     [&](Device one) { return paths()[one] == link.port; });
    handlers.received = [&read = reads_[*device], pass_on = handlers.received](
                            std::span<const std::uint8_t> bytes, HostTime arrived) {
      read = {read.bytes + bytes.size(), bytes.size()};
      pass_on(bytes, arrived);
    };
    return VirtualPorts::open(link, std::move(handlers), refusal);
  }

 private:
  PerDevice<Read>& reads_;
};

/// Records in this process, which is killed before the write of that number if there are so many.
PerDevice<std::vector<std::uint8_t>> record(const TemporaryFolder& folder, std::uint64_t seed,
                                            PerDevice<Read>& reads, std::size_t last_write) {
  NotedPorts ports(seed, reads);
  PortOptions options;
  options.recording = recording_options(folder, simulation::default_profile(), short_plan());
  for (const Device device : all_devices) options.recording.profile.link(device).port = ports.paths()[device];
  WatchedDisk disk([writes = std::size_t{0}, last_write](std::string_view call, const auto&) mutable {
    if (call == "append" && ++writes == last_write) std::raise(SIGKILL);
  });
  options.recording.disk = &disk;
  record_ports(options, ports);
  PerDevice<std::vector<std::uint8_t>> delivered;
  for (const Device device : all_devices) delivered[device] = ports.delivered(device);
  return delivered;
}

class EachInstant : public ::testing::TestWithParam<unsigned> {};
INSTANTIATE_TEST_SUITE_P(Instants, EachInstant, ::testing::Range(1U, 11U));

TEST_P(EachInstant, LosesNoChunkButPerhapsTheLast) {
  const std::uint64_t seed = GetParam();
  std::mt19937 random(GetParam());
  const std::size_t last_write = 500 + random() % 1500;
  const TemporaryFolder folder;
  const SharedReads reads;
  const pid_t process = fork();
  if (process == 0) {
    alarm(120);
    record(folder, seed, *reads, last_write);
    _exit(0);
  }
  int status = 0;
  waitpid(process, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) << status;

  const auto recovered = recover(folder.path());
  ASSERT_EQ(recovered.size(), 1U);
  EXPECT_EQ(recovered[0].state, session::State::recovered);
  const RawRecording raw = session::read_raw(recovered[0].session);
  EXPECT_FALSE(raw.complete);
  const TemporaryFolder other_folder;
  const SharedReads other_reads;
  const auto whole = record(other_folder, seed, *other_reads, 0);
  for (const Device device : all_devices) {
    const std::vector<std::uint8_t>& kept = raw.received[device].bytes;
    EXPECT_LE(kept.size(), (*reads)[device].bytes) << name_of(device);
    EXPECT_GE(kept.size(), (*reads)[device].bytes - (*reads)[device].last_bytes) << name_of(device);
    ASSERT_LE(kept.size(), whole[device].size());
    EXPECT_TRUE(std::equal(kept.begin(), kept.end(), whole[device].begin())) << name_of(device);
  }
}

}  // namespace
}  // namespace thermorig::rig::test
