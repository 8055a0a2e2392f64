// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "thermorig/core/printable.h"
#include "thermorig/rig/doctor/checks.h"

namespace thermorig::doctor {

namespace {

/// There are some, and udev gave them to whoever sits at the machine.
bool may_open_all(const std::vector<PortFacts>& ports) {
  return !ports.empty() &&
         std::all_of(ports.begin(), ports.end(), [](const PortFacts& port) { return port.may_open; });
}

Check user_check(const HostFacts& facts) {
  Check check{.name = "user"};
  const std::string user = facts.user.empty() ? "this user" : facts.user;
  const std::string group = facts.serial_group.empty() ? "dialout" : facts.serial_group;
  if (facts.is_root) {
    check.warning = true;
    check.result = "you are root: mistakes can damage the system, and recordings will be root's";
    check.advice = fmt::format("log in as a user in the group {}", group);
  } else if (facts.in_group) {
    check.result = fmt::format("{} is in the group {}", user, group);
  } else if (facts.group_file_names_user) {
    check.warning = true;
    check.result = fmt::format("{} is in the group {}, but this login began before that", user, group);
    check.advice = "log out and in again";
  } else if (facts.has_port_rules && may_open_all(facts.ports)) {
    check.result = fmt::format("{} may open the ports without being in the group {}", user, group);
  } else {
    check.warning = true;
    check.result = fmt::format("{} is not in the group {}, which serial ports belong to", user, group);
    check.advice = fmt::format("sudo usermod -aG {} {}, then log out and in again", group,
                               facts.user.empty() ? "$USER" : facts.user);
  }
  return check;
}

std::string name_of_port(const PortFacts& port) {
  return port.asked.role ? std::string(name_of(*port.asked.role)) + " port" : port.asked.path;
}

std::string bus_advice(const PortFacts& port, const HostFacts& facts) {
  const std::string user = facts.user.empty() ? "$USER" : facts.user;
  if (!port.bus_group.empty())
    return fmt::format("sudo usermod -aG {} {}, then log out and in again", port.bus_group, user);
  return fmt::format(
      "sudo apt install i2c-tools (gives buses to the group i2c), sudo usermod -aG i2c {}, then restart",
      user);
}

/// A half-frame has 15,000 bits: 1,664 bytes of nine.
void add_bus_check(const PortFacts& port, std::vector<Check>& checks) {
  if (!port.bus_hz) return;
  constexpr double enough_hz = 350e3;  // for 16 half-frames a second; the EEPROM bears 400 kHz at most
  Check check{.name = name_of_port(port) + " speed",
              .result = fmt::format("the bus runs at {:.0f} kHz", 1e-3 * *port.bus_hz)};
  if (*port.bus_hz < enough_hz) {
    check.warning = true;
    check.result += ": at 100 kHz a half-frame takes 0.15 s to read, so 4 a second are the most";
    check.advice =
        port.bus_is_bridge
            ? "options hid_mcp2221 i2c_clk_freq=400 in /etc/modprobe.d/thermorig.conf, then plug it in "
              "again"
            : "dtparam=i2c_arm=on,i2c_arm_baudrate=400000 in /boot/firmware/config.txt, then restart";
  }
  checks.push_back(std::move(check));
}

Check access_failure(const PortFacts& port, const HostFacts& facts) {
  Check check{.name = name_of_port(port), .result = port.asked.path};
  if (!port.usb_id.empty()) check.result += fmt::format(" ({}, {})", port.usb_id, port.driver);
  if (!port.exists) {
    check.code = ExitCode::device_missing;
    check.result += " is not there";
    check.advice = port.is_bus ? "Raspberry Pi: sudo raspi-config nonint do_i2c 0; a USB bridge: plug it in; "
                                 "sudo modprobe i2c-dev"
                               : "check the USB cable; `thermorig ports` lists the ports";
  } else if (!port.may_open) {
    check.code = ExitCode::no_permission;
    check.result += " may not be opened by this user";
    check.advice = port.is_bus ? bus_advice(port, facts) : user_check(facts).advice;
    if (!port.is_bus && !check.advice.empty() && !facts.has_port_rules)
      check.advice += "; or, at its own screen: install 60-thermorig.rules (docs/doctor.md)";
    if (check.advice.empty()) check.advice = "see who owns it: ls -l " + shell_word(port.asked.path);
  } else if (port.holder) {
    check.code = ExitCode::no_permission;
    check.result += fmt::format(" is held by {}", *port.holder);
    check.advice = "stop that program";
  } else {
    check.result += " can be opened and is not in use";
  }
  return check;
}

/// A warning where nobody asked for this port.
Check access_check(const PortFacts& port, const HostFacts& facts) {
  Check check = access_failure(port, facts);
  if (port.asked.role || !check.failed()) return check;
  check.code = ExitCode::ok;
  check.warning = true;
  return check;
}

/// Only what is not as it should be: most adapters have neither.
void add_usb_checks(const PortFacts& port, std::vector<Check>& checks) {
  if (port.latency_timer_ms) {
    const bool lowered = *port.latency_timer_ms > 1;  // io::Loop::open asks for it (ASYNC_LOW_LATENCY)
    checks.push_back(
        {.name = name_of_port(port) + " latency",
         .result = fmt::format("the FTDI latency timer is {} ms{}", *port.latency_timer_ms,
                               lowered ? "; a recording asks for 1 ms while it has the port open" : "")});
  }
  if (port.may_suspend) {
    checks.push_back({.name = name_of_port(port) + " power",
                      .result = "USB autosuspend is on for it: it may fall asleep between messages",
                      .advice = fmt::format("echo on | sudo tee {}/power/control", port.usb_device.string()),
                      .warning = true});
  }
}

Check no_port() {
  return {.name = "ports",
          .result = "no USB serial port is there: camera, gyro and servo are not plugged in",
          .advice =
              "plug them in with USB data cables (some cables only charge); `thermorig ports` shows which is "
              "which",
          .warning = true};
}

bool asked_port_is_missing(const HostFacts& facts) {
  return std::any_of(facts.ports.begin(), facts.ports.end(),
                     [](const PortFacts& port) { return port.asked.role && !port.exists; });
}

Check braille_check(const HostFacts& facts) {
  Check check{.name = "brltty"};
  const std::string advice =
      "sudo apt remove brltty, or switch its rule off: sudo ln -s /dev/null /etc/udev/rules.d/" +
      facts.braille_rule.substr(facts.braille_rule.rfind('/') + 1) +
      " && sudo udevadm control --reload; then unplug the adapter and plug it in again";
  const bool kept_off = facts.braille_kept_off && facts.adapters_without_port.empty();
  if (facts.braille_adapters.empty() || kept_off) {
    check.result = "it leaves a rig's adapters alone";
  } else if (!facts.adapters_without_port.empty()) {
    if (asked_port_is_missing(facts))
      check.code = ExitCode::device_missing;
    else
      check.warning = true;
    check.result = fmt::format("an adapter {} is plugged in and has no port: brltty takes it ({})",
                               fmt::join(facts.adapters_without_port, ", "), facts.braille_rule);
    check.advice = advice;
  } else {
    check.warning = true;
    check.result = fmt::format("its rules take adapters {} as braille displays ({})",
                               fmt::join(facts.braille_adapters, ", "), facts.braille_rule);
    check.advice = advice;
  }
  return check;
}

Check modem_check(const HostFacts& facts) {
  Check check{.name = "ModemManager"};
  const bool all_ignored =
      !facts.ports.empty() && std::all_of(facts.ports.begin(), facts.ports.end(), [](const PortFacts& port) {
        return port.usb_id.empty() || port.modem_manager_ignores;
      });
  if (!facts.modem_manager) {
    check.result = "not running";
  } else if (all_ignored) {
    check.result = "it runs and leaves these ports alone";
  } else {
    check.warning = true;
    check.result = "it runs: it writes modem commands to new ports for about 10 s";
    check.advice =
        "sudo systemctl mask --now ModemManager, or install 60-thermorig.rules, which sets ID_MM_PORT_IGNORE "
        "(docs/doctor.md)";
  }
  return check;
}

Check clock_check(const HostFacts& facts) {
  Check check{.name = "clock", .result = facts.clock_source.empty() ? "unknown" : facts.clock_source};
  if (facts.clock_source == "jiffies") {
    check.code = ExitCode::failed;
    check.result += ": it steps by 1 to 10 ms, no frame can be timed with it";
    check.advice = "a kernel with high resolution timers; look for clocksource= in /proc/cmdline";
  } else if (facts.clock_source == "acpi_pm" || facts.clock_source == "hpet") {
    check.warning = true;
    check.result += ": each reading takes about a microsecond, and the kernel had a reason to leave tsc";
    check.advice = "journalctl -k | grep -i clocksource shows the reason";
  }
  return check;
}

Check governor_check(const HostFacts& facts) {
  Check check{.name = "processor",
              .result = facts.governor.empty() ? "no frequency governor" : facts.governor};
  if (facts.governor == "powersave" && !facts.governor_is_active_driver) {
    check.warning = true;
    check.result += ": it stays at its lowest speed";
    check.advice = "echo performance | sudo tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor";
  }
  return check;
}

Check power_check(const HostFacts& facts) {
  Check check{.name = "power", .result = "mains, or a machine without a battery"};
  if (facts.on_battery) {
    check.warning = true;
    check.result = "on battery: the system may suspend during a recording";
    check.advice = "plug it in, or: systemd-inhibit thermorig record ...";
  }
  return check;
}

Check plugin_check(const HostFacts& facts) {
  Check check{.name = "HDF5 plugins", .result = "HDF5_PLUGIN_PATH is not set"};
  if (facts.plugin_path) {
    check.warning = true;
    check.result =
        fmt::format("HDF5_PLUGIN_PATH is \"{}\"{}: other programs load code from there for sessions",
                    *facts.plugin_path, facts.plugin_path_exists ? "" : ", which is not there");
    check.advice = "unset HDF5_PLUGIN_PATH; sessions need no plugin";
  }
  return check;
}

}  // namespace

std::vector<Check> judge_host(const HostFacts& facts) {
  std::vector<Check> checks{user_check(facts)};
  if (facts.ports.empty()) checks.push_back(no_port());
  for (const PortFacts& port : facts.ports) {
    checks.push_back(access_check(port, facts));
    add_usb_checks(port, checks);
    add_bus_check(port, checks);
  }
  for (const auto& judge_one : {braille_check, modem_check}) checks.push_back(judge_one(facts));
  for (const Check& check : judge_machine(facts)) checks.push_back(check);
  return checks;
}

std::vector<Check> judge_machine(const HostFacts& facts) {
  std::vector<Check> checks;
  for (const auto& judge_one : {clock_check, governor_check, power_check, plugin_check})
    checks.push_back(judge_one(facts));
  return checks;
}

}  // namespace thermorig::doctor
