// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

#include "exclusive.h"
#include "thermorig/core/profile.h"

struct sp_port;

namespace thermorig::io {

/// A port, opened exclusively and set up: raw, 8N1, one byte wakes a reader. Real ports are configured by
/// libserialport; a pty (which libserialport cannot open) and any other terminal by termios alone.
class OpenPort {
 public:
  /// Throws what open_exclusively() throws; device_missing when the driver refuses the settings.
  explicit OpenPort(const PortProfile& link, Refusal refusal = Refusal::names_holder);
  ~OpenPort();
  OpenPort(const OpenPort&) = delete;
  OpenPort& operator=(const OpenPort&) = delete;

  int fd() const { return descriptor_.get(); }
  const std::string& path() const { return path_; }

  /// Gives the port back: until then its name stays taken, even if the device is gone.
  void close();

 private:
  struct ClosePort {
    void operator()(sp_port* port) const;
  };
  void configure_serial(const PortProfile& link);

  std::string path_;
  Descriptor descriptor_;
  std::unique_ptr<sp_port, ClosePort> serial_;  // of real ports
};

}  // namespace thermorig::io
