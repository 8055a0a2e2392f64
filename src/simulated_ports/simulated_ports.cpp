// SPDX-License-Identifier: MIT
#include "thermorig/simulated_ports/simulated_ports.h"

#include <poll.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <exception>
#include <mutex>
#include <thread>

#include "served_port.h"
#include "thermorig/core/error.h"
#include "thermorig/io/host.h"
#include "thermorig/simulated_ports/avr_firmware.h"

namespace thermorig {

namespace {

// How late a chunk may be written: below the jitter of any USB link, above the cost of waking up.
constexpr timespec slice{.tv_sec = 0, .tv_nsec = 1'000'000};

}  // namespace

std::unique_ptr<simulation::Firmware> make_firmware(FirmwareChoice choice) {
  if (choice == FirmwareChoice::avr_image)
    if (auto firmware = make_avr_firmware()) return firmware;
  return simulation::make_host_firmware();
}

struct SimulatedPorts::Server {
  simulation::VirtualRigConfig config;
  std::unique_ptr<simulation::Firmware> firmware;  // until the rig takes it
  std::string firmware_description;
  PerDevice<ServedPort> ports;
  PerDevice<std::string> paths;
  bool keeps_truth = false;
  std::unique_ptr<simulation::VirtualRig> rig;

  std::thread thread;
  std::atomic<bool> stopping = false;
  std::exception_ptr failure;  // read after the thread has ended
  mutable std::mutex mutex;    // of the shared tally
  ServingTally shared_tally;

  // Of the serving thread.
  ServingTally tally;
  HostTime serving_since{};  // what the rig sent while it was being built is late by that, and by no fault
  double lag_sum_s = 0.0;

  void start();
  void serve();
  void serve_slice(HostTime time);
  void deliver(const Chunk& chunk);
  void take_commands();
  void share_tally();
  void wait();
};

void SimulatedPorts::Server::start() {
  config.start = io::now();
  rig = std::make_unique<simulation::VirtualRig>(config, std::move(firmware));
  rig->keep_truth(keeps_truth);
  if (keeps_truth)
    for (ServedPort& port : ports.values) port.keep_delivered();
  thread = std::thread([this] { serve(); });
}

void SimulatedPorts::Server::serve() {
  serving_since = io::now();
  try {
    while (!stopping) {
      serve_slice(io::now());
      wait();
    }
  } catch (const Error&) {
    failure = std::current_exception();
    for (ServedPort& port : ports.values) {
      port.unplug();
      port.readable_fd();
    }
  }
}

void SimulatedPorts::Server::serve_slice(HostTime time) {
  for (const Chunk& chunk : rig->advance(time)) deliver(chunk);
  take_commands();
  share_tally();
}

void SimulatedPorts::Server::deliver(const Chunk& chunk) {
  PerDevice<PortTally>& tallies = tally.ports;
  ports[chunk.device].deliver(chunk.bytes);
  const bool heard = ports[chunk.device].tally().bytes_delivered > tallies[chunk.device].bytes_delivered;
  tallies[chunk.device] = ports[chunk.device].tally();
  if (!heard || chunk.arrived < serving_since) return;
  const double lag_s = to_s(io::now() - chunk.arrived);
  ++tally.chunks;
  lag_sum_s += lag_s;
  tally.worst_lag_s = std::max(tally.worst_lag_s, lag_s);
}

/// Each at the time when it was read: had this thread to wait since the slice began, the program may have
/// written after that, and nothing may reach the servo before it was written.
void SimulatedPorts::Server::take_commands() {
  for (const Device device : all_devices) {
    ports[device].deliver_waiting();
    const auto bytes = ports[device].receive();
    if (!bytes.empty()) rig->send(device, bytes, io::now());
    tally.ports[device] = ports[device].tally();
  }
}

void SimulatedPorts::Server::share_tally() {
  tally.thread_cpu_s = io::thread_cpu_s();
  tally.elapsed_s = to_s(io::now() - config.start);
  if (tally.chunks > 0) tally.mean_lag_s = lag_sum_s / static_cast<double>(tally.chunks);
  const std::lock_guard lock(mutex);
  shared_tally = tally;
}

void SimulatedPorts::Server::wait() {
  std::array<pollfd, device_count> waiting{};
  for (const Device device : all_devices)
    waiting[index_of(device)] = {.fd = ports[device].readable_fd(), .events = POLLIN, .revents = 0};
  ppoll(waiting.data(), waiting.size(), &slice, nullptr);
}

SimulatedPorts::SimulatedPorts(const simulation::VirtualRigConfig& config, FirmwareChoice choice)
    : SimulatedPorts(config, make_firmware(choice)) {}

SimulatedPorts::SimulatedPorts(const simulation::VirtualRigConfig& config,
                               std::unique_ptr<simulation::Firmware> firmware)
    : server_(std::make_unique<Server>()) {
  server_->config = config;
  server_->firmware_description = firmware->description();
  server_->firmware = std::move(firmware);
  for (const Device device : all_devices) server_->paths[device] = server_->ports[device].path();
}

SimulatedPorts::~SimulatedPorts() {
  server_->stopping = true;
  if (server_->thread.joinable()) server_->thread.join();
}

const PerDevice<std::string>& SimulatedPorts::paths() const {
  return server_->paths;
}

const std::string& SimulatedPorts::firmware_description() const {
  return server_->firmware_description;
}

void SimulatedPorts::keep_truth() {
  assert(!server_->rig);
  server_->keeps_truth = true;
}

void SimulatedPorts::start() {
  assert(!server_->rig);
  server_->start();
}

void SimulatedPorts::stop() {
  server_->stopping = true;
  if (server_->thread.joinable()) server_->thread.join();
  if (server_->failure) std::rethrow_exception(server_->failure);
}

void SimulatedPorts::unplug(Device device) {
  server_->ports[device].unplug();
}

std::string SimulatedPorts::plug_in(Device device) {
  return server_->ports[device].plug_in();
}

ServingTally SimulatedPorts::tally() const {
  const std::lock_guard lock(server_->mutex);
  return server_->shared_tally;
}

const simulation::VirtualRig& SimulatedPorts::rig() const {
  assert(server_->rig && !server_->thread.joinable());
  return *server_->rig;
}

const std::vector<std::uint8_t>& SimulatedPorts::delivered(Device device) const {
  assert(!server_->thread.joinable());
  return server_->ports[device].delivered();
}

}  // namespace thermorig
