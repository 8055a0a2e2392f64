// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "thermorig/core/error.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::rig {

/// Bytes -> session: the pipeline over all chunks in order of arrival, twice; the first pass fits what the
/// second uses. Chunks with equal times go camera, gyro, servo. State: complete if the plan was finished,
/// partial if the recorder closed it early, recovered if it was cut short.
session::Session build_session(RawRecording raw);

/// What a journal became.
struct Finalised {
  session::Session session;
  std::uint64_t bytes_ignored = 0;  // at its end, that could not be read back
  bool is_retired = true;           // else the journal is kept: it holds more, or its end is not in it
};

/// What becomes of a journal without its end: somebody may still be writing it, or is known not to.
enum class WithoutEnd : std::uint8_t { keep, retire };

/// A journal -> its session. The journal is removed once the session is on the disk and holds all of it; what
/// could not be read back stays, as it may interest somebody. Nobody else may make the session meanwhile: the
/// journal's lock is the caller's. `clock_set_ns`: SessionFile::clock_set_ns. Throws Error: not_a_session,
/// storage.
Finalised finalise(const std::filesystem::path& journal, const std::filesystem::path& session,
                   files::Disk& disk = files::real_disk(), WithoutEnd without_end = WithoutEnd::keep,
                   std::int64_t clock_set_ns = 0);

/// `empty`: a journal in which nothing had been recorded yet when its program ended; it is removed.
/// `left_part`: of a file that a killed program was writing; it is removed.
enum class RecoveryKind : std::uint8_t { made, already_there, empty, failed, in_use, left_part };

/// What became of one journal (or session) that recover() looked at.
struct RecoveryResult {
  RecoveryKind kind = RecoveryKind::made;
  std::filesystem::path source;   // journal, or the session itself if it was given
  std::filesystem::path session;  // empty if it failed, or there is none
  session::State state = session::State::recovered;
  std::uint64_t frames = 0;
  std::uint64_t valid = 0;
  std::uint64_t chunks = 0;
  std::uint64_t bytes_ignored = 0;  // torn tail: at most the chunk that was being written
  bool of_cut_session = false;      // made of a session file that lacks these bytes at its end
  std::string message;              // where there is no session: why
  ExitCode code = ExitCode::ok;     // for `failed`: not_a_session; storage if it is the disk's fault; failed
};

/// A journal, a session, or a folder that is searched for journals: each journal without a session becomes
/// one. Journals are kept where something was ignored. It may be killed and run again; run twice it gives the
/// same, losses included, as long as the journal is there. What a killed program left of a file that it was
/// writing is removed, and named behind all else of its folder. A journal without its end is kept as well
/// where the file system cannot tell that nobody writes it. In a folder one journal or one folder that fails
/// keeps nobody from the others: it is a `failed` of its own. Of a session that was cut short another one is
/// made beside it, NAME_salvaged.h5, of the raw bytes that are left. Throws Error(not_a_session) if `path` is
/// neither, Error(bad_usage) if it does not exist, and for a single journal Error(storage) if the disk
/// refuses to be written.
std::vector<RecoveryResult> recover(const std::filesystem::path& path,
                                    files::Disk& disk = files::real_disk());

/// What killed programs left in a folder, at any depth, of files that they were writing: recover() removes
/// it. Nothing of what cannot be read.
std::vector<std::filesystem::path> left_parts(const std::filesystem::path& folder,
                                              files::Disk& disk = files::real_disk());

}  // namespace thermorig::rig
