// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/core/device.h"

namespace thermorig::doctor {

/// A port that is to be looked at.
struct AskedPort {
  std::string path;            // "/dev/ttyUSB0", links followed
  std::optional<Device> role;  // none: whatever it is
};

/// What the system says of one port.
struct PortFacts {
  AskedPort asked;
  bool exists = false;
  bool may_open = false;                // by its permissions and this process's groups
  std::string usb_id;                   // "1a86:7523"; empty if it is not USB
  std::filesystem::path usb_device;     // its folder in /sys
  std::string driver;                   // "ftdi_sio", "ch341", "cdc_acm"
  std::optional<int> latency_timer_ms;  // FTDI only
  bool may_suspend = false;             // USB autosuspend is on for it
  bool modem_manager_ignores = false;
  std::optional<std::string> holder;  // "process 4711 (screen)"; none of a bus, which several may use
  bool is_bus = false;                // /dev/i2c-N
  std::string bus_group;              // that may open it; empty if it is root's alone, or not known
  std::optional<double> bus_hz;       // where the system says it
  bool bus_is_bridge = false;         // on USB: its driver has the speed
};

/// What stands on this machine between a recording and its devices.
struct HostFacts {
  bool is_root = false;
  std::string user;
  std::string serial_group;            // "dialout" (Debian) or "uucp"; empty if there is none
  bool in_group = false;               // this process is
  bool group_file_names_user = false;  // the next login will be
  bool has_port_rules = false;         // 60-thermorig.rules is in force
  std::vector<PortFacts> ports;
  std::string braille_rule;                        // file of udev rules that gives our adapters to brltty
  std::vector<std::string> braille_adapters;       // usb ids that it takes
  bool braille_kept_off = false;                   // by 91-thermorig-brltty.rules
  std::vector<std::string> adapters_without_port;  // plugged in, of these ids, and no port has appeared
  bool modem_manager = false;                      // runs
  std::string clock_source;                        // "tsc"; empty if the system does not say
  std::string governor;                            // of the processor's speed; empty if it has none
  bool governor_is_active_driver = false;          // intel_pstate, amd_pstate: "powersave" is not slow there
  bool on_battery = false;
  std::optional<std::string> plugin_path;  // HDF5_PLUGIN_PATH
  bool plugin_path_exists = false;
};

/// Reads /proc, /sys, /etc, /run and the udev rules below `root` ("/", or a made-up tree). What cannot be
/// read is left as if it were not there. Without `asked` it looks at every USB serial port.
HostFacts look_at_host(const std::filesystem::path& root, const std::vector<AskedPort>& asked);

}  // namespace thermorig::doctor
