// SPDX-License-Identifier: MIT
#include "port_search.h"

#include <utility>
#include <vector>

namespace thermorig::rig {

namespace {
constexpr auto longest_refusal = std::chrono::seconds(10);
}  // namespace

void PortSearch::opened(Device device, const std::string& name) {
  sought_[device] = Sought{.port = loop_.know_port(name)};
  sought_[device].port->open_path = sought_[device].port->info.path;
}

void PortSearch::reopened(Device device, const std::string& path) {
  sought_[device].port->open_path = path;
}

void PortSearch::missing(Device device, const std::string& name) {
  sought_[device] = Sought{.port = io::KnownPort{.name = name, .info = {}}};
}

std::optional<std::string> PortSearch::look(Device device, HostTime now) {
  Sought& sought = sought_[device];
  if (!sought.port) return std::nullopt;
  sought.port->open_path.clear();
  const HostDuration wait = sought.is_hopeless ? HostDuration(long_period) : HostDuration(period);
  if (sought.last_look && now - *sought.last_look < wait) return std::nullopt;
  sought.last_look = now;
  std::vector<io::KnownPort> others;
  for (const Device other : all_devices)
    if (other != device && sought_[other].port) others.push_back(*sought_[other].port);
  auto found = loop_.find_again(*sought.port, others);
  if (!found) forgive(sought);
  return found;
}

void PortSearch::forgive(Sought& sought) {
  sought.refused_since.reset();
  sought.is_hopeless = false;
}

bool PortSearch::is_hopeless(Device device, const Error& error, HostTime now) {
  Sought& sought = sought_[device];
  if (error.code() != ExitCode::no_permission) {
    forgive(sought);
    return false;
  }
  if (!sought.refused_since) sought.refused_since = now;
  return now - *sought.refused_since >= longest_refusal && !std::exchange(sought.is_hopeless, true);
}

}  // namespace thermorig::rig
