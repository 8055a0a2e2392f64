// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "thermorig/core/raw_recording.h"
#include "thermorig/session/session.h"

namespace thermorig::rig {

/// Bytes -> session: the pipeline over all chunks in order of arrival, twice; the first pass fits what the
/// second uses. Chunks with equal times go camera, gyro, servo. State: complete if the plan was finished,
/// partial if the recorder closed it early, recovered if it was cut short.
session::Session build_session(RawRecording raw);

/// A closed journal -> its session; the journal is removed once the session is on the disk.
/// Throws Error: not_a_session, storage.
session::Session finalise(const std::filesystem::path& journal, const std::filesystem::path& session);

enum class RecoveryKind : std::uint8_t { made, already_there, failed, in_use };

/// What became of one journal (or session) that recover() looked at.
struct RecoveryResult {
  RecoveryKind kind = RecoveryKind::made;
  std::filesystem::path source;   // journal, or the session itself if it was given
  std::filesystem::path session;  // empty if it failed
  session::State state = session::State::recovered;
  std::uint64_t frames = 0;
  std::uint64_t valid = 0;
  std::uint64_t chunks = 0;
  std::uint64_t bytes_ignored = 0;  // torn tail: at most the chunk that was being written
  std::string message;              // for `failed` and `in_use`: why
  std::vector<std::filesystem::path>
      removed;  // parts of sessions that a program which was killed left behind
};

/// A journal, a session, or a folder that is searched for journals: each journal without a session becomes
/// one. Journals are kept where something was ignored. Run twice it gives the same, losses included, as long
/// as the journal is there. What a program that was killed left of a session's file is removed. Throws
/// Error(not_a_session) if `path` is neither, Error(bad_usage) if it does not exist.
std::vector<RecoveryResult> recover(const std::filesystem::path& path);

/// Makes a session again from its own raw bytes, with this version's clocks and label rules; replaces it.
session::Session reprocess(const std::filesystem::path& session);

}  // namespace thermorig::rig
