// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "thermorig/io/files/descriptor.h"
#include "thermorig/io/port.h"

namespace thermorig::io {

/// What a device says of itself: blanks and line ends around it left out, the rest printable().
std::string device_text(std::string_view text);

/// The USB topology in a sysfs path: ".../usb1/1-4/1-4.2/1-4.2:1.0/ttyUSB0" -> "1-4.2"; empty if there is
/// none.
std::string usb_topology(std::string_view sysfs_path);

/// Configuration and interface in it: "1.0"; an adapter with several ports has one interface for each.
std::string usb_interface(std::string_view sysfs_path);

/// Whether the kernel's list of its consoles ("tty0 ttyS0", as sysfs prints it) names the port at `path`.
bool names_console(const std::string& active_consoles, const std::string& path);

/// Whether the kernel writes its messages to this port: opening it would change the settings of the console.
bool is_system_console(const std::string& path);

/// "the ports that exist are /dev/ttyUSB0 (USB2.0-Serial), /dev/ttyACM0 (Arduino Uno)", or that there is
/// none.
std::string existing_ports_text();

/// Opens a terminal device (non-blocking, never the controlling terminal) and locks it. `path` has no links
/// in it. Throws Error: device_missing (gone, not a terminal, no hardware), no_permission (not allowed, in
/// use, the console).
files::Descriptor open_exclusively(const std::string& path, Refusal refusal);

/// Takes the lock that every thermorig takes on its ports; it goes with the descriptor. `path`: of what is
/// open. Throws Error(no_permission) if somebody else has it, or, unless it is to be brief, has the port open
/// without it.
files::Descriptor lock_exclusively(files::Descriptor port, const std::string& path, Refusal refusal);

}  // namespace thermorig::io
