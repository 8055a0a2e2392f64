// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "thermorig/io/files/descriptor.h"
#include "thermorig/io/port.h"

namespace thermorig::io {

/// What makes the bytes of a port that is no device file of its own. Its end ends the bytes.
class PortSource {
 public:
  virtual ~PortSource() = default;
  /// Why the bytes have ended, once they have.
  virtual std::string why_ended() const = 0;
};

/// The program's end of a camera on a bus: to read and write, non-blocking.
struct I2cPort {
  files::Descriptor end;
  std::unique_ptr<PortSource> source;  // has a thread; to be destroyed behind `end`
};

/// Opens the bus exclusively among thermorigs (other programs may use other devices on it), and starts to
/// read the camera there. `path` has no links in it. Throws Error: device_missing (no bus, or one that cannot
/// do it, no camera), no_permission (and which group may), as open_exclusively() does.
I2cPort open_i2c_port(const std::string& path, Refusal refusal);

/// The buses on which a camera answers, of those where asking harms nothing: USB bridges, and a small
/// computer's own pins. A bus that another thermorig reads counts as well.
std::vector<PortInfo> list_i2c_ports();

/// Why there is no such bus, and what to try.
[[noreturn]] void refuse_missing_i2c_bus(const std::string& path);

}  // namespace thermorig::io
