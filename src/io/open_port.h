// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/core/profile.h"
#include "thermorig/io/files/descriptor.h"
#include "thermorig/io/port.h"

namespace thermorig::io {

/// A port, opened exclusively and set up: raw, 8N1, one byte wakes a reader; what came before is thrown away.
/// Real ports are configured by libserialport; a pty (which libserialport cannot open) and any other terminal
/// by termios alone. Throws what open_exclusively() throws; device_missing when the driver refuses the
/// settings.
files::Descriptor open_port(const PortProfile& link, Refusal refusal);

}  // namespace thermorig::io
