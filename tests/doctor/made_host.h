// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

#include "thermorig/rig/doctor/host_facts.h"

namespace thermorig::doctor::test {

/// A made-up machine: a tree of /proc, /sys, /etc and /dev as look_at_host() reads it. At first nothing is
/// wrong with it: a user of the group dialout, a CH340 on /dev/ttyUSB0, an FTDI on /dev/ttyUSB1.
class MadeHost {
 public:
  MadeHost();
  ~MadeHost();
  MadeHost(const MadeHost&) = delete;
  MadeHost& operator=(const MadeHost&) = delete;

  /// `path` begins with '/'; folders are made.
  void write(const std::string& path, const std::string& text) const;
  void link(const std::string& path, const std::string& target) const;  // the target as it is
  void remove(const std::string& path) const;
  void plug_in(const std::string& port, const std::string& usb_path, const std::string& usb_id,
               const std::string& driver) const;

  HostFacts facts() const;  // of camera on ttyUSB0 and gyro on ttyUSB1
  const std::filesystem::path& root() const { return root_; }

 private:
  std::filesystem::path root_;
};

}  // namespace thermorig::doctor::test
