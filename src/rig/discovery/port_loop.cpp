// SPDX-License-Identifier: MIT
#include "thermorig/rig/discovery/port_loop.h"

#include <utility>

namespace thermorig::rig {

HostTime SystemPortLoop::now() const {
  return io::now();
}

PortLoop::PortId SystemPortLoop::open(const PortProfile& link, PortHandlers handlers, io::Refusal refusal) {
  return loop_.open(link, std::move(handlers), refusal);
}

void SystemPortLoop::write(PortId port, std::span<const std::uint8_t> bytes) {
  loop_.write(port, bytes);
}

void SystemPortLoop::keep_emergency_bytes(PortId port, std::span<const std::uint8_t> bytes) {
  loop_.keep_emergency_bytes(port, bytes);
}

void SystemPortLoop::close(PortId port) {
  loop_.close(port);
}

void SystemPortLoop::every(HostDuration period, std::function<void(HostTime)> tick) {
  loop_.every(period, std::move(tick));
}

void SystemPortLoop::on_signal(std::function<void(int signal)> handler) {
  loop_.on_signal(std::move(handler));
}

void SystemPortLoop::run() {
  loop_.run();
}

void SystemPortLoop::stop() {
  loop_.stop();
}

bool SystemPortLoop::has_baud(const std::string& port) const {
  return !io::is_pseudo_terminal(port) && !io::is_i2c_bus(port);
}

io::KnownPort SystemPortLoop::know_port(const std::string& name) const {
  return io::know_port(name);
}

std::optional<std::string> SystemPortLoop::find_again(const io::KnownPort& port,
                                                      const std::vector<io::KnownPort>& others) const {
  return io::find_again(port, others);
}

}  // namespace thermorig::rig
