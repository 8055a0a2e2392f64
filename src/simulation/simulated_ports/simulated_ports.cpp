// SPDX-License-Identifier: MIT
#include "thermorig/simulation/simulated_ports/simulated_ports.h"

#include <poll.h>

#include <array>
#include <atomic>
#include <cassert>
#include <exception>
#include <thread>

#include "avr_firmware.h"
#include "rig_server.h"
#include "thermorig/core/error.h"
#include "thermorig/io/port.h"

namespace thermorig {

namespace {

// How late a chunk may be written: below the jitter of any USB link, above the cost of waking up.
constexpr timespec slice{.tv_sec = 0, .tv_nsec = 1'000'000};

std::unique_ptr<io::DeviceSide> new_terminal(std::string& path) {
  auto terminal = std::make_unique<io::Pty>();
  path = terminal->path();
  return terminal;
}

PerDevice<std::unique_ptr<io::DeviceSide>> new_terminals(PerDevice<std::string>& paths) {
  PerDevice<std::unique_ptr<io::DeviceSide>> terminals;
  for (const Device device : all_devices) terminals[device] = new_terminal(paths[device]);
  return terminals;
}

}  // namespace

std::unique_ptr<simulation::Firmware> make_firmware(FirmwareChoice choice) {
  if (choice == FirmwareChoice::avr_image)
    if (auto firmware = make_avr_firmware()) return firmware;
  return simulation::make_host_firmware();
}

/// The thread that keeps the rig at the wall clock.
struct SimulatedPorts::Server {
  Server(const simulation::VirtualRigConfig& config, std::unique_ptr<simulation::Firmware> firmware)
      : firmware_description(firmware->description()),
        rig(config, std::move(firmware), new_terminals(paths), io::now) {}
  ~Server() { end(); }

  std::string firmware_description;
  PerDevice<std::string> paths;
  RigServer rig;
  std::thread thread;
  std::atomic<bool> stopping = false;
  std::exception_ptr failure;  // read after the thread has ended

  void serve();
  void wait() const;
  void end();
};

void SimulatedPorts::Server::serve() {
  try {
    while (!stopping) {
      rig.serve();
      wait();
    }
  } catch (const Error&) {
    failure = std::current_exception();
  }
}

void SimulatedPorts::Server::wait() const {
  const PerDevice<int> fds = rig.readable_fds();
  std::array<pollfd, device_count> waiting{};
  for (const Device device : all_devices)
    waiting[index_of(device)] = {.fd = fds[device], .events = POLLIN, .revents = 0};
  ppoll(waiting.data(), waiting.size(), &slice, nullptr);
}

void SimulatedPorts::Server::end() {
  stopping = true;
  if (thread.joinable()) thread.join();
}

SimulatedPorts::SimulatedPorts(const simulation::VirtualRigConfig& config, FirmwareChoice choice)
    : SimulatedPorts(config, config.profile.servo.protocol == ServoProfile().protocol
                                 ? make_firmware(choice)
                                 : simulation::make_servo(config)) {}

SimulatedPorts::SimulatedPorts(const simulation::VirtualRigConfig& config,
                               std::unique_ptr<simulation::Firmware> firmware)
    : server_(std::make_unique<Server>(config, std::move(firmware))) {}

SimulatedPorts::~SimulatedPorts() = default;

const PerDevice<std::string>& SimulatedPorts::paths() const {
  return server_->paths;
}

const std::string& SimulatedPorts::firmware_description() const {
  return server_->firmware_description;
}

void SimulatedPorts::keep_truth() {
  server_->rig.keep_truth();
}

void SimulatedPorts::start() {
  server_->rig.switch_on();
  server_->thread = std::thread([server = server_.get()] { server->serve(); });
}

void SimulatedPorts::stop() {
  server_->end();
  if (server_->failure) std::rethrow_exception(server_->failure);
}

void SimulatedPorts::unplug(Device device) {
  server_->rig.unplug(device);
}

std::string SimulatedPorts::plug_in(Device device) {
  std::string path;
  server_->rig.plug_in(device, new_terminal(path));
  return path;
}

ServingTally SimulatedPorts::tally() const {
  return server_->rig.tally();
}

const simulation::VirtualRig& SimulatedPorts::rig() const {
  assert(!server_->thread.joinable());
  return server_->rig.rig();
}

const std::vector<std::uint8_t>& SimulatedPorts::delivered(Device device) const {
  assert(!server_->thread.joinable());
  return server_->rig.delivered(device);
}

}  // namespace thermorig
