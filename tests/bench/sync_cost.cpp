// SPDX-License-Identifier: MIT
// What each sync policy costs on the disk of a folder: a journal grows by the default rig's chunks in real
// time, a second thread syncs it; times of the syncs, of the appends meanwhile, and how old the oldest byte
// was that a sync brought home.
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "rig/recording/journal_sync.h"
#include "thermorig/rig/recording/sync_policy.h"
#include "thermorig/storage/journal/journal.h"

namespace {

using namespace thermorig;
using Clock = std::chrono::steady_clock;

constexpr double chunks_hz = 520.0;  // of the default rig, all ports
constexpr std::size_t chunk_bytes = 32;
constexpr int chunks_per_frame = 65;

double ms(Clock::duration time) {
  return std::chrono::duration<double, std::milli>(time).count();
}

double at_share(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1,
                         static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

double cpu_s() {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

struct Figures {
  std::vector<double> sync_ms, append_ms, age_ms;
  double cpu_share = 0;
};

/// The syncs of one policy, timed; as rig::JournalSync makes them.
void keep_syncing(journal::JournalWriter& journal, const rig::SyncPolicy& policy,
                  const std::atomic<bool>& stop, const std::atomic<int>& frames, Figures& figures) {
  Clock::time_point begin = Clock::now();
  HostDuration expected{};
  int seen = 0;
  while (!stop) {
    Clock::time_point oldest = begin;
    if (policy.when == rig::SyncWhen::each_frame) {
      while (!stop && frames == seen) std::this_thread::sleep_for(std::chrono::microseconds(200));
      seen = frames;
      oldest = Clock::now();
    } else {
      std::this_thread::sleep_until(begin + rig::pause_before_sync(policy.period, expected));
    }
    begin = Clock::now();
    journal.sync();
    const auto end = Clock::now();
    expected = rig::expected_sync(expected, std::chrono::duration_cast<HostDuration>(end - begin));
    figures.sync_ms.push_back(ms(end - begin));
    figures.age_ms.push_back(ms(end - oldest));
  }
}

Figures measure(const std::filesystem::path& path, const rig::SyncPolicy& policy, double duration_s) {
  Figures figures;
  RecordingHeader header;
  header.environment = "bench";
  header.uuid = "00000000-0000-4000-8000-000000000000";
  journal::JournalWriter journal(path, header, 8U << 20U);
  std::atomic<bool> stop = false;
  std::atomic<int> frames = 0;
  std::thread syncs;
  const double cpu_before = cpu_s();
  if (policy.when != rig::SyncWhen::end)
    syncs = std::thread([&] { keep_syncing(journal, policy, stop, frames, figures); });
  const std::vector<std::uint8_t> chunk(chunk_bytes, 0x5A);
  const auto begin = Clock::now();
  for (int i = 0; i < static_cast<int>(duration_s * chunks_hz); ++i) {
    std::this_thread::sleep_until(
        begin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(i / chunks_hz)));
    const auto before = Clock::now();
    journal.received(Device::camera, chunk, host_time_ns(i));
    figures.append_ms.push_back(ms(Clock::now() - before));
    if (i % chunks_per_frame == 0) ++frames;
  }
  stop = true;
  if (syncs.joinable()) syncs.join();
  figures.cpu_share = (cpu_s() - cpu_before) / duration_s;
  journal.close(host_time_ns(1));
  std::filesystem::remove(path);
  return figures;
}

}  // namespace

int main(int count, char** words) {
  bool json = false;
  double duration_s = 10.0;
  std::filesystem::path folder = ".";
  for (int i = 1; i < count; ++i) {
    const std::string word = words[i];
    if (word == "--json")
      json = true;
    else if (word == "--quick")
      duration_s = 2.0;
    else
      folder = word;
  }
  nlohmann::json lines = nlohmann::json::array();
  if (!json)
    fmt::print("{:<7} {:>7} {:>11} {:>11} {:>11} {:>13} {:>13} {:>13} {:>7}\n", "--sync", "syncs/s",
               "sync p50 ms", "sync p99 ms", "worst ms", "oldest byte ms", "append p50 us", "append p99 us",
               "CPU %");
  for (const char* const text : {"end", "1000", "125", "frame", "20"}) {
    const auto policy = rig::sync_policy_from(text);
    const Figures figures =
        measure(folder / fmt::format("sync_cost.{}.journal", ::getpid()), policy, duration_s);
    const nlohmann::json line{{"sync", text},
                              {"syncs_per_s", static_cast<double>(figures.sync_ms.size()) / duration_s},
                              {"sync_p50_ms", at_share(figures.sync_ms, 0.5)},
                              {"sync_p99_ms", at_share(figures.sync_ms, 0.99)},
                              {"sync_worst_ms", at_share(figures.sync_ms, 1.0)},
                              {"oldest_byte_ms", at_share(figures.age_ms, 1.0)},
                              {"append_p50_us", at_share(figures.append_ms, 0.5) * 1e3},
                              {"append_p99_us", at_share(figures.append_ms, 0.99) * 1e3},
                              {"cpu_percent", figures.cpu_share * 100}};
    if (!json)
      fmt::print("{:<7} {:>7.1f} {:>11.2f} {:>11.2f} {:>11.2f} {:>13.1f} {:>13.1f} {:>13.1f} {:>7.2f}\n",
                 text, line["syncs_per_s"].get<double>(), line["sync_p50_ms"].get<double>(),
                 line["sync_p99_ms"].get<double>(), line["sync_worst_ms"].get<double>(),
                 line["oldest_byte_ms"].get<double>(), line["append_p50_us"].get<double>(),
                 line["append_p99_us"].get<double>(), line["cpu_percent"].get<double>());
    lines.push_back(line);
  }
  if (json) fmt::print("{}\n", lines.dump(2));
  return 0;
}
