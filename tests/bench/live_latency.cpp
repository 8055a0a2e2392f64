// SPDX-License-Identifier: MIT
// How long a frame takes from the feed of the chunk that completes it to its row and the screen's figures,
// the network included; what that costs; and whether memory stays flat over a day.
#include <fmt/format.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string_view>

#include "fast_rig.h"
#include "thermorig/core/statistics.h"
#include "thermorig/estimators/live/live_estimates.h"
#include "thermorig/estimators/live/scores.h"
#include "thermorig/pipeline/replay.h"
#include "thermorig/sensors/wire/servo_messages.h"
#include "timing_rig.h"

namespace thermorig::bench {
namespace {

constexpr double hour_s = 3600.0;

/// Figures in the order in which they are printed.
struct Figure {
  std::string key;
  double value = 0.0;
};
using Figures = std::vector<Figure>;

model::Model reference_model() {
  model::Model model;
  model.weights = network::initial_weights({.frames = 3, .reduction = 1}, 1);
  model.scaling = {200.0F, 22.0F, 3.0F};
  return model;
}

/// All that a live run does with bytes, but the journal and the page.
class LiveChain {
 public:
  explicit LiveChain(const RigProfile& profile)
      : LiveChain(profile, estimators::Bank({}, reference_model(), profile)) {}

  /// How many frames the step completed.
  std::size_t feed(const ReplayStep& step) {
    const std::vector<Measurement> measurements = pipeline::feed(pipeline_, step);
    const pipeline::Streams streams = pipeline_.take_streams();
    frames_ += streams.frames.size();
    gyro_ += streams.gyro.size();
    for (const Measurement& measurement : measurements) {
      scorer_.add(estimates_.add(measurement, step.time));
      scores_ = scorer_.scores();
    }
    return measurements.size();
  }

  std::size_t frames() const { return frames_; }
  std::size_t gyro() const { return gyro_; }
  const live::LiveScores& scores() const { return scores_; }

 private:
  LiveChain(const RigProfile& profile, estimators::Bank bank)
      : pipeline_(profile), scorer_(live::columns_of(bank)), estimates_(std::move(bank)) {}

  pipeline::Pipeline pipeline_;
  live::Scorer scorer_;
  live::LiveEstimates estimates_;
  live::LiveScores scores_;
  std::size_t frames_ = 0, gyro_ = 0;
};

double seconds_of(clockid_t clock) {
  timespec now{};
  ::clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

/// Of each frame: on the wall, and what the thread itself ran. On a machine that is busy with other things
/// the two differ by what those took.
struct Latencies {
  std::vector<double> wall_us, thread_us;

  void add_to(Figures& figures) {
    add(figures, "latency", wall_us);
    add(figures, "latency_processor", thread_us);
  }

 private:
  static void add(Figures& figures, const std::string& name, std::vector<double>& values_us) {
    std::sort(values_us.begin(), values_us.end());
    figures.push_back({name + "_p50_us", quantile(values_us, 0.5)});
    figures.push_back({name + "_p99_us", quantile(values_us, 0.99)});
    figures.push_back({name + "_max_us", values_us.back()});
  }
};

// ---- latency, dropped messages, processor ----

std::vector<Leg> legs_until(double end_s) {
  std::vector<Leg> legs;
  for (double at_s = 3.0; at_s + 8.0 < end_s; at_s += 10.0)
    legs.push_back(
        {at_s, 8.0, (legs.size() % 2 == 0 ? 1.0 : -1.0) * 20.0 * static_cast<double>(1 + legs.size() % 8)});
  return legs;
}

/// Messages that came whole, by what the rig says it sent.
double arrived(const std::vector<simulation::SentMessage>& sent, const RawStream& received) {
  return static_cast<double>(
      std::count_if(sent.begin(), sent.end(), [&](const simulation::SentMessage& message) {
        return message.arrives && message.span.end <= received.bytes.size();
      }));
}

void add_fast_run(Figures& figures, double duration_s) {
  const Recorded recorded = record(fast_rig(), legs_until(duration_s), duration_s);
  const RawRecording& raw = recorded.raw;
  LiveChain chain(raw.header.profile);
  Latencies latencies;
  Replay replay(raw);
  const double before_s = seconds_of(CLOCK_PROCESS_CPUTIME_ID);
  while (const auto step = replay.next()) {
    const double wall_s = seconds_of(CLOCK_MONOTONIC), thread_s = seconds_of(CLOCK_THREAD_CPUTIME_ID);
    const std::size_t completed = chain.feed(*step);
    const double ran_s = seconds_of(CLOCK_THREAD_CPUTIME_ID) - thread_s;
    const double took_s = seconds_of(CLOCK_MONOTONIC) - wall_s;
    latencies.wall_us.insert(latencies.wall_us.end(), completed, 1e6 * took_s);
    latencies.thread_us.insert(latencies.thread_us.end(), completed, 1e6 * ran_s);
  }
  const double used_s = seconds_of(CLOCK_PROCESS_CPUTIME_ID) - before_s;
  figures.push_back({"virtual_s", duration_s});
  figures.push_back({"frames", static_cast<double>(chain.frames())});
  figures.push_back({"frames_counted", static_cast<double>(chain.scores().counted)});
  figures.push_back({"gyro_samples", static_cast<double>(chain.gyro())});
  figures.push_back({"dropped_frames", arrived(recorded.rig->sent_frames(), raw.received[Device::camera]) -
                                           static_cast<double>(chain.frames())});
  figures.push_back({"dropped_gyro_samples", arrived(recorded.rig->sent_gyro(), raw.received[Device::gyro]) -
                                                 static_cast<double>(chain.gyro())});
  latencies.add_to(figures);
  figures.push_back({"processor_share_of_a_core", used_s / duration_s});
}

// ---- memory ----

double resident_mb() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t total = 0, resident = 0;
  statm >> total >> resident;
  return static_cast<double>(resident) * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1e6;
}

/// What is written to the servo, and when: greeting, legs of 20 s for ever, a refresh and a ping a step.
class EndlessScript {
 public:
  explicit EndlessScript(const ServoProfile& servo) : servo_(servo) {}

  std::vector<std::uint8_t> bytes_at(double now_s) {
    std::vector<std::uint8_t> bytes = wire::refresh_bytes();
    append(bytes, wire::ping_bytes(++token_, 3000));
    if (now_s < next_s_) return bytes;
    next_s_ += begun_ < 3 ? 0.1 : 22.0;
    append(bytes, next_command());
    return bytes;
  }

 private:
  static void append(std::vector<std::uint8_t>& to, const std::vector<std::uint8_t>& more) {
    to.insert(to.end(), more.begin(), more.end());
  }

  std::vector<std::uint8_t> next_command() {
    const std::uint8_t sequence = sequence_++;
    switch (begun_++) {
      case 0:
        return wire::hello_bytes(sequence);
      case 1:
        return wire::configure_bytes(sequence, servo_);
      case 2:
        return wire::arm_bytes(sequence, 0.0);
      default:
        return wire::run_bytes(sequence, {.leg = static_cast<std::uint16_t>(1 + begun_ % 60'000),
                                          .turn_back = true,
                                          .rate_dps = (begun_ % 2 == 0 ? 1.0 : -1.0) * (20.0 + begun_ % 100),
                                          .acceleration_dps2 = servo_.acceleration_dps2,
                                          .duration_s = 20.0});
    }
  }

  ServoProfile servo_;
  double next_s_ = 0.3;
  unsigned begun_ = 0;
  std::uint8_t sequence_ = 0;
  std::uint32_t token_ = 0;
};

/// Before the bytes of one read or write in the pipe.
struct PipedFront {
  std::uint64_t place = 0;  // the device that sent them; device_count: they went to the servo
  std::int64_t time_ns = 0;
  std::uint64_t size = 0;
};

void write_record(std::FILE* to, std::uint64_t place, HostTime time, const std::vector<std::uint8_t>& bytes) {
  const PipedFront front{place, to_ns(time), bytes.size()};
  std::fwrite(&front, sizeof front, 1, to);
  std::fwrite(bytes.data(), 1, bytes.size(), to);
}

void simulate_to(std::FILE* to, const simulation::VirtualRigConfig& config, double duration_s) {
  simulation::VirtualRig rig(config, simulation::make_host_firmware());
  EndlessScript script(config.profile.servo);
  HostTime now = config.start;
  while (to_s(now - config.start) < duration_s) {
    const std::vector<std::uint8_t> bytes = script.bytes_at(to_s(now - config.start));
    rig.send(Device::servo, bytes, now);
    write_record(to, device_count, now, bytes);
    now += std::chrono::microseconds(98'700);
    for (const Chunk& chunk : rig.advance(now))
      write_record(to, index_of(chunk.device), chunk.arrived, chunk.bytes);
  }
}

/// The rig in a process of its own, whose memory is not ours: the read end of the pipe that it fills.
std::FILE* start_rig(const simulation::VirtualRigConfig& config, double duration_s) {
  int ends[2];
  if (::pipe(ends) != 0) return nullptr;
  if (::fork() == 0) {
    ::close(ends[0]);
    std::FILE* const to = ::fdopen(ends[1], "w");
    simulate_to(to, config, duration_s);
    std::fclose(to);
    ::_exit(0);
  }
  ::close(ends[1]);
  return ::fdopen(ends[0], "r");
}

/// Feeds the chain with what comes, telling resident memory by the hour.
void add_long_run(Figures& figures, double hours) {
  const simulation::VirtualRigConfig config = rig_on(table_links(false).back(), 2);
  std::FILE* const from = start_rig(config, hours * hour_s + 1.0);
  LiveChain chain(config.profile);
  std::vector<std::uint8_t> bytes;
  PipedFront front;
  double hour = 1.0;
  while (from != nullptr && std::fread(&front, sizeof front, 1, from) == 1) {
    bytes.resize(front.size);
    if (std::fread(bytes.data(), 1, bytes.size(), from) != bytes.size()) break;
    const HostTime time = host_time_ns(front.time_ns);
    const bool received = front.place < device_count;
    const auto from_device = received ? std::optional(all_devices[front.place]) : std::nullopt;
    const auto to_device = received ? std::nullopt : std::optional(Device::servo);
    chain.feed({.from = from_device, .to = to_device, .bytes = bytes, .time = time});
    if (to_s(time - config.start) < hour * hour_s) continue;
    fmt::print(stderr, "after {:.0f} h: {:.3f} MB\n", hour, resident_mb());
    if (hour == 1.0 || hour == hours)
      figures.push_back({fmt::format("resident_after_{:.0f}_h_mb", hour), resident_mb()});
    hour += 1.0;
  }
  if (from != nullptr) std::fclose(from);
  ::wait(nullptr);
  figures.push_back({"long_run_frames", static_cast<double>(chain.frames())});
  figures.push_back({"long_run_frames_counted", static_cast<double>(chain.scores().counted)});
}

// ---- output ----

void print(const Figures& figures, bool json) {
  std::string text;
  for (const auto& [key, value] : figures)
    text += json ? fmt::format("{}\"{}\":{:.10g}", text.empty() ? "" : ",", key, value)
                 : fmt::format("{:<28} {:.10g}\n", key, value);
  fmt::print("{}", json ? "{" + text + "}\n" : text);
}

int run(const std::vector<std::string_view>& words) {
  const auto has = [&](std::string_view word) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  const bool quick = has("--quick");
  Figures figures;
  add_long_run(figures, quick ? 2.0 : 24.0);
  add_fast_run(figures, quick ? 30.0 : 120.0);
  print(figures, has("--json"));
  return 0;
}

}  // namespace
}  // namespace thermorig::bench

int main(int count, char** words) {
  return thermorig::bench::run({words + 1, words + count});
}
