// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "thermorig/core/annotation.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/storage/session/stored_file.h"

namespace thermorig::session {

/// What is left of a recording in a session file that was cut short.
struct Salvaged {
  RawRecording raw;                     // not `complete`; ends with the last chunk that is left
  std::vector<Annotation> annotations;  // that were made afterwards
  std::uint64_t bytes_missing = 0;      // of the file
};

/// Does the file end before the end that it states?
bool is_cut_short(const StoredFile& file);

/// Throws Error(not_a_session) if it does: how much is there, and how to make something of that.
void require_whole(const StoredFile& file);

/// Header and raw bytes as far as they are there: each stream up to its first chunk that is not. What
/// describes a file stands at its front, and raw bytes, which everything else can be made of, behind that;
/// files of programs before that order have them at their end. Nothing but the check sums of chunks says that
/// the rest is sound. A child process looks at it first, if one tries files. Throws Error(not_a_session)
/// where no frame is left, and as read_session() does.
Salvaged salvage(const StoredFile& file);

}  // namespace thermorig::session
