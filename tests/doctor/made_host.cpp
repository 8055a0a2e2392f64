// SPDX-License-Identifier: MIT
#include "made_host.h"

#include <unistd.h>

#include <fstream>

namespace thermorig::doctor::test {

namespace fs = std::filesystem;

MadeHost::MadeHost() {
  std::string name = (fs::temp_directory_path() / "thermorig-host-XXXXXX").string();
  root_ = mkdtemp(name.data());
  // Somebody who does not own the files that this test makes.
  const std::string user = std::to_string(getuid() + 4242);
  write("/proc/self/status", "Name:\tthermorig\nUid:\t" + user + "\t" + user + "\t" + user + "\t" + user +
                                 "\nGid:\t1000\t1000\t1000\t1000\nGroups:\t20 1000 \n");
  write("/proc/self/environ", std::string("HOME=/home/anna\0LANG=C\0", 23));
  write("/proc/1/comm", "systemd\n");
  write("/etc/passwd", "root:x:0:0::/root:/bin/sh\nanna:x:" + user + ":1000::/home/anna:/bin/sh\n");
  write("/etc/group", "root:x:0:\nuucp:x:10:\ndialout:x:20:anna\nanna:x:1000:\n");
  write("/sys/devices/system/clocksource/clocksource0/current_clocksource", "tsc\n");
  write("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "schedutil\n");
  plug_in("ttyUSB0", "1-4.1", "1a86:7523", "ch341-uart");
  plug_in("ttyUSB1", "1-4.2", "0403:6001", "ftdi_sio");
  write("/sys/bus/usb-serial/devices/ttyUSB1/latency_timer", "1\n");
}

MadeHost::~MadeHost() {
  fs::remove_all(root_);
}

void MadeHost::write(const std::string& path, const std::string& text) const {
  const fs::path file = root_ / fs::path(path).relative_path();
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

void MadeHost::link(const std::string& path, const std::string& target) const {
  const fs::path file = root_ / fs::path(path).relative_path();
  fs::create_directories(file.parent_path());
  fs::create_symlink(target, file);
}

void MadeHost::remove(const std::string& path) const {
  fs::remove_all(root_ / fs::path(path).relative_path());
}

void MadeHost::plug_in(const std::string& port, const std::string& usb_path, const std::string& usb_id,
                       const std::string& driver) const {
  const std::string device = "/sys/devices/usb1/" + usb_path;
  write(device + "/idVendor", usb_id.substr(0, 4) + "\n");
  write(device + "/idProduct", usb_id.substr(5) + "\n");
  write(device + "/power/control", "on\n");
  link("/sys/bus/usb/devices/" + usb_path, "../../../devices/usb1/" + usb_path);
  if (port.empty()) return;
  const std::string serial = device + "/" + usb_path + ":1.0/" + port;
  write(serial + "/tty/" + port + "/dev", "188:" + port.substr(6) + "\n");
  link(serial + "/driver", "../../../../../bus/usb-serial/drivers/" + driver);
  link("/sys/class/tty/" + port + "/device",
       "../../../devices/usb1/" + usb_path + "/" + usb_path + ":1.0/" + port);
  write("/sys/class/tty/" + port + "/dev", "188:" + port.substr(6) + "\n");
  write("/dev/" + port, "");
  fs::permissions(root_ / "dev" / port, fs::perms(0666));
}

HostFacts MadeHost::facts() const {
  return look_at_host(root_, {{"/dev/ttyUSB0", Device::camera}, {"/dev/ttyUSB1", Device::gyro}});
}

}  // namespace thermorig::doctor::test
