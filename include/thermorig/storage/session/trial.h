// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "thermorig/storage/session/stored_file.h"

namespace thermorig::session {

/// From here on a child process reads a session file before this process does, by the very same reader, with
/// limits on memory and time, and may do nothing but read: libhdf5 crashes on files that were made for it.
/// What the child does not survive is refused with Error(not_a_session), and read by nobody else. Without it
/// files are read at once, as suits tests.
void try_sessions_first();

/// Attributes that are not as thermorig wrote them, "/gyro@signal"; formats before 1.3 cannot tell. Nothing
/// that read_session() gives is taken from them: it refuses a session whose profile was changed. Throws as
/// read_session() does.
std::vector<std::string> altered_attributes(const StoredFile& file);

}  // namespace thermorig::session
