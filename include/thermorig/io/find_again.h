// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "thermorig/io/port.h"

namespace thermorig::io {

/// A port as it was when it was opened: what it is found again by.
struct KnownPort {
  std::string name;  // as it was given: "/dev/ttyUSB0", a by-id link
  PortInfo info;     // `path`: the device file behind the name; the rest is empty where it is not USB
  std::string open_path = {};  // the device file that is open now; empty: none
};

/// The port as it is listed now; of one that is not listed (a pty) its path alone. Throws what resolve_port()
/// does.
KnownPort know_port(const std::string& name);

/// Where the port is now, `listed` being those that exist and `named` the device file behind its name, if
/// there is one: the same USB socket and interface and the same kind of device, under whatever name; else
/// what its name leads to, unless that is known to be another kind of device, or the place of one of
/// `others`. What one of those has open is never taken. None: it is not there.
std::optional<std::string> choose_again(const KnownPort& port, const std::vector<PortInfo>& listed,
                                        const std::optional<std::string>& named,
                                        const std::vector<KnownPort>& others);

/// The same on this machine, now. A pseudo terminal that another program has open is not it: a terminal.
std::optional<std::string> find_again(const KnownPort& port, const std::vector<KnownPort>& others);

}  // namespace thermorig::io
