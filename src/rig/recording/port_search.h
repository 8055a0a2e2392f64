// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "thermorig/core/device.h"
#include "thermorig/core/error.h"
#include "thermorig/core/time.h"
#include "thermorig/rig/discovery/port_loop.h"

namespace thermorig::rig {

/// Looks for the ports of devices that went, now and then.
class PortSearch {
 public:
  explicit PortSearch(const PortLoop& loop) : loop_(loop) {}

  static constexpr auto period = std::chrono::milliseconds(500);
  static constexpr auto long_period = std::chrono::seconds(10);  // once it was refused for good

  /// The port was open under that name: by what it is now, it will be found again.
  void opened(Device device, const std::string& name);

  /// It was found again, at `path`, and is open.
  void reopened(Device device, const std::string& path);

  /// The port was never there: its name is all that is known of it.
  void missing(Device device, const std::string& name);

  /// Where the device's port is now; none: it is not there, or it was looked for just now.
  std::optional<std::string> look(Device device, HostTime now);

  /// The port is there, but did not open. True once, when that has lasted: rules for a new device file, and
  /// programs that look at every new port, take some seconds.
  bool is_hopeless(Device device, const Error& error, HostTime now);

 private:
  struct Sought {
    std::optional<io::KnownPort> port;  // none: it has no name
    std::optional<HostTime> last_look;
    std::optional<HostTime> refused_since;
    bool is_hopeless = false;
  };
  static void forgive(Sought& sought);

  const PortLoop& loop_;
  PerDevice<Sought> sought_;
};

}  // namespace thermorig::rig
