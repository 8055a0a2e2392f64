// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "thermorig/storage/sandbox/sandbox.h"
#include "thermorig/storage/sandbox/sealed_copy.h"

namespace thermorig::session {

/// From here on whatever opens a session file has a child process read it first, with limits on memory and
/// time, no files and no way out: libhdf5 crashes on files that were made for it. To be called once, at the
/// start of a program, while it has no second thread; without it files are read at once, as suits tests and
/// files of one's own. `others`: what else children may be asked to make of a session, numbered from
/// first_other_task. Throws Error(failed) if there can be no child.
void try_sessions_first(const std::vector<sandbox::Task>& others = {});
inline constexpr std::size_t first_other_task = 3;

/// The copy of a file that a child process has read to its end: what read_session() does first. This process
/// reads none that the child has refused. May be called from several threads. Throws what the child threw,
/// Error(not_a_session) for a file that kills its reader ("damaged or hostile"), Error(failed) for one that
/// keeps it busy for longer than any sound file of its size keeps a slow computer ("could not be read within
/// ..."), and as sandbox::SealedCopy does.
sandbox::SealedCopy tried_copy(const std::filesystem::path& path);

/// The same for a copy that was made already.
sandbox::SealedCopy tried(sandbox::SealedCopy copy);

/// Attributes that are not as thermorig wrote them, "/gyro@signal"; formats before 1.3 cannot tell. Nothing
/// that read_session() gives is taken from them: it refuses a session whose profile was changed. A child
/// process looks at them, if one tries files. Throws as tried_copy() and read_session() do.
std::vector<std::string> altered_attributes(const sandbox::SealedCopy& copy);

}  // namespace thermorig::session
