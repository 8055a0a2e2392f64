// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "thermorig/core/raw_recording.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::bench {

/// A link as the table names it.
struct TableLink {
  std::string name;  // "ftdi16"
  simulation::LinkConfig config;
};

/// FTDI with its timer at 16 ms and at 1 ms, CH340, CDC.
std::vector<TableLink> table_links(bool loaded);

/// Which simulated world the table is made of: honest, unless it is asked for another.
void choose_world(const std::string& name);
const std::string& chosen_world();

/// A rig of that world.
simulation::VirtualRigConfig rig_in_world(std::uint64_t seed, const std::string& environment);

/// One of the four environments for each index, in turn.
std::string environment_of(std::size_t index);

/// The default rig with every device on one kind of link, latencies as its profile says them. On CDC camera
/// and gyro are USB devices of their own, without a baud rate; the servo's board has a CDC bridge before its
/// UART (an Arduino Uno).
simulation::VirtualRigConfig rig_on(const TableLink& link, std::uint64_t seed);

struct Leg {
  double begin_s = 0.0;
  double duration_s = 0.0;
  double rate_dps = 0.0;
};

/// A recording in virtual time with its truth, and what a live pipeline made of it.
struct Recorded {
  std::unique_ptr<simulation::VirtualRig> rig;  // holds the truth
  RawRecording raw;
  pipeline::Streams live;
};

/// Greets and arms the servo as the recorder does, pings it, drives the legs and keeps the rest of the time
/// still. Second 0 is 100 s on the host's clock.
Recorded record(const simulation::VirtualRigConfig& config, const std::vector<Leg>& legs, double duration_s);

HostTime bench_start();

}  // namespace thermorig::bench
