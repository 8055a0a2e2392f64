// SPDX-License-Identifier: MIT
#include "timing_cost.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <utility>

#include "thermorig/pipeline/pipeline.h"
#include "thermorig/rig/recording/finalise.h"
#include "timing_rig.h"

namespace thermorig::bench {
namespace {

constexpr double hour_s = 3600.0;

/// Legs of 20 s with the default rig's speeds, over and over.
std::vector<Leg> legs_for(double duration_s) {
  std::vector<Leg> legs;
  int number = 0;
  for (double at_s = 5.0; at_s + 25.0 < duration_s; at_s += 22.0, ++number)
    legs.push_back({at_s, 20.0, (number % 2 == 0 ? 1.0 : -1.0) * (20.0 + 20.0 * (number % 10))});
  return legs;
}

/// Processor time of this program since it began. Nothing else of it runs meanwhile.
double processor_s() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

struct ChunkPlace {
  Device device;
  std::size_t index;
  HostTime arrived;
};

std::vector<ChunkPlace> chunks_by_arrival(const RawRecording& raw) {
  std::vector<ChunkPlace> chunks;
  for (const Device device : all_devices)
    for (std::size_t i = 0; i < raw.received[device].chunk_count(); ++i)
      chunks.push_back({device, i, raw.received[device].time(i)});
  std::stable_sort(chunks.begin(), chunks.end(),
                   [](const ChunkPlace& a, const ChunkPlace& b) { return a.arrived < b.arrived; });
  return chunks;
}

/// A live pipeline over all bytes, as the recorder feeds it; what it decodes is thrown away.
double live_s(const RawRecording& raw, const std::vector<ChunkPlace>& chunks) {
  pipeline::Pipeline live(raw.header.profile);
  const RawStream& to_servo = raw.sent[Device::servo];
  const double before_s = processor_s();
  std::size_t sent = 0;
  for (const ChunkPlace& chunk : chunks) {
    for (; sent < to_servo.chunk_count() && to_servo.time(sent) <= chunk.arrived; ++sent)
      live.sent(Device::servo, to_servo.chunk(sent), to_servo.time(sent));
    live.feed(chunk.device, raw.received[chunk.device].chunk(chunk.index), chunk.arrived);
    live.take_streams();
  }
  return processor_s() - before_s;
}

}  // namespace

void add_cost(const TableSize& size, std::vector<Figure>& figures) {
  const double duration_s = size.seeds < 10 ? hour_s / 10 : hour_s;
  const Recorded recorded = record(rig_on(table_links(false)[1], 77), legs_for(duration_s), duration_s);
  const std::vector<ChunkPlace> chunks = chunks_by_arrival(recorded.raw);
  const double feeding_s = live_s(recorded.raw, chunks);
  const double before_s = processor_s();
  const session::Session session = rig::build_session(recorded.raw);
  const double took_s = processor_s() - before_s;
  figures.push_back({.section = "Cost on this machine",
                     .row = "causal: chunk to stamped messages and labels",
                     .column = "processor time",
                     .key = "cost_causal_us_per_chunk",
                     .unit = "us a chunk or s an hour",
                     .value = 1e6 * feeding_s / static_cast<double>(chunks.size()),
                     .at_most = 5.0,
                     .note = fmt::format("{} chunks over FTDI at 1 ms, scanners included", chunks.size())});
  figures.push_back({.section = "Cost on this machine",
                     .row = "finalising: bytes to a session, both passes and all fits",
                     .column = "processor time",
                     .key = "cost_finalising_s_per_hour",
                     .unit = "us a chunk or s an hour",
                     .value = took_s * hour_s / duration_s,
                     .at_most = 10.0,
                     .note = fmt::format("{} frames, {} gyro samples, {} telemetry", session.frames.size(),
                                         session.gyro.size(), session.servo.size())});
}

}  // namespace thermorig::bench
