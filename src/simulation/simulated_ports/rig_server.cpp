// SPDX-License-Identifier: MIT
#include "rig_server.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "thermorig/core/error.h"
#include "thermorig/io/host.h"

namespace thermorig {

RigServer::RigServer(const simulation::VirtualRigConfig& config,
                     std::unique_ptr<simulation::Firmware> firmware,
                     PerDevice<std::unique_ptr<io::DeviceSide>> sides, Clock now)
    : config_(config), firmware_(std::move(firmware)), now_(std::move(now)) {
  for (const Device device : all_devices) plug_in(device, std::move(sides[device]));
}

void RigServer::keep_truth() {
  assert(!rig_);
  keeps_truth_ = true;
  for (ServedPort& port : ports_.values) port.keep_delivered();
}

void RigServer::switch_on() {
  assert(!rig_);
  config_.start = now_();
  rig_ = std::make_unique<simulation::VirtualRig>(config_, std::move(firmware_));
  rig_->keep_truth(keeps_truth_);
  serving_since_ = now_();
}

void RigServer::serve() {
  try {
    for (ServedPort& port : ports_.values) port.follow_plug();
    serve_chunks();
    take_commands();
    share_tally();
  } catch (const Error&) {
    unplug_all();
    throw;
  }
}

void RigServer::unplug_all() {
  for (ServedPort& port : ports_.values) {
    port.plug_in(nullptr);
    port.follow_plug();
  }
}

void RigServer::serve_chunks() {
  for (const Chunk& chunk : rig_->advance(now_())) deliver(chunk);
}

void RigServer::deliver(const Chunk& chunk) {
  PerDevice<PortTally>& tallies = tally_.ports;
  ports_[chunk.device].deliver(chunk.bytes);
  const bool heard = ports_[chunk.device].tally().bytes_delivered > tallies[chunk.device].bytes_delivered;
  tallies[chunk.device] = ports_[chunk.device].tally();
  if (!heard || chunk.arrived < serving_since_) return;
  const double lag_s = to_s(now_() - chunk.arrived);
  ++tally_.chunks;
  lag_sum_s_ += lag_s;
  tally_.worst_lag_s = std::max(tally_.worst_lag_s, lag_s);
}

/// Each at the time when it was read: had the caller to wait since the step began, the program may have
/// written after that, and nothing may reach the servo before it was written.
void RigServer::take_commands() {
  for (const Device device : all_devices) {
    if (ports_[device].was_opened()) rig_->opened(device, now_());
    ports_[device].deliver_waiting();
    const auto bytes = ports_[device].receive();
    if (!bytes.empty()) rig_->send(device, bytes, now_());
    tally_.ports[device] = ports_[device].tally();
  }
}

void RigServer::share_tally() {
  tally_.thread_cpu_s = io::thread_cpu_s();
  tally_.elapsed_s = to_s(now_() - config_.start);
  if (tally_.chunks > 0) tally_.mean_lag_s = lag_sum_s_ / static_cast<double>(tally_.chunks);
  const std::lock_guard lock(mutex_);
  shared_tally_ = tally_;
}

PerDevice<int> RigServer::readable_fds() const {
  PerDevice<int> fds;
  for (const Device device : all_devices) fds[device] = ports_[device].readable_fd();
  return fds;
}

void RigServer::plug_in(Device device, std::unique_ptr<io::DeviceSide> side) {
  ports_[device].plug_in(std::move(side));
}

void RigServer::unplug(Device device) {
  ports_[device].plug_in(nullptr);
}

ServingTally RigServer::tally() const {
  const std::lock_guard lock(mutex_);
  return shared_tally_;
}

const simulation::VirtualRig& RigServer::rig() const {
  assert(rig_);
  return *rig_;
}

const std::vector<std::uint8_t>& RigServer::delivered(Device device) const {
  return ports_[device].delivered();
}

}  // namespace thermorig
