// SPDX-License-Identifier: MIT
#include "timing_cost.h"

#include <fmt/format.h>

#include <chrono>
#include <utility>

#include "thermorig/rig/finalise.h"
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

}  // namespace

void add_cost(const TableSize& size, std::vector<Figure>& figures) {
  const double duration_s = size.seeds < 10 ? hour_s / 10 : hour_s;
  const Recorded recorded = record(rig_on(table_links(false)[1], 77), legs_for(duration_s), duration_s);
  const auto before = std::chrono::steady_clock::now();
  const session::Session session = rig::build_session(recorded.raw);
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
  figures.push_back({.section = "Cost on this machine",
                     .row = "causal: chunk to stamped messages and labels",
                     .column = "processor time",
                     .key = "cost_causal_us_per_chunk",
                     .unit = "us a chunk or s an hour",
                     .value = 1e6 * recorded.feeding_s / static_cast<double>(recorded.chunks),
                     .at_most = 5.0,
                     .note = fmt::format("{} chunks over FTDI at 1 ms, scanners included", recorded.chunks)});
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
