// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "thermorig/io/files/descriptor.h"
#include "thermorig/io/port.h"

namespace thermorig::io {

/// Opens a terminal device (non-blocking, never the controlling terminal) and locks it. `path` has no links
/// in it. Throws Error: device_missing (gone, not a terminal, no hardware), no_permission (not allowed, in
/// use, the console).
files::Descriptor open_exclusively(const std::string& path, Refusal refusal);

/// Takes the lock that every thermorig takes on its ports; it goes with the descriptor. `path`: of what is
/// open. Throws Error(no_permission) if somebody else has it, or, unless it is to be brief, has the port open
/// without it.
files::Descriptor lock_exclusively(files::Descriptor port, const std::string& path, Refusal refusal);

}  // namespace thermorig::io
