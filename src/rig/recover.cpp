// SPDX-License-Identifier: MIT
#include <signal.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <optional>
#include <string_view>

#include "file_lock.h"
#include "thermorig/core/error.h"
#include "thermorig/journal/journal.h"
#include "thermorig/rig/finalise.h"
#include "thermorig/rig/session_file.h"

namespace thermorig::rig {

namespace {

std::uint64_t chunks_of(const RawRecording& raw) {
  std::uint64_t chunks = 0;
  for (const Device device : all_devices) chunks += raw.received[device].chunk_count();
  return chunks;
}

std::uint64_t valid_in(const session::Session& session) {
  return static_cast<std::uint64_t>(std::count_if(session.samples.begin(), session.samples.end(),
                                                  [](const LabelledSample& sample) { return sample.valid; }));
}

RecoveryResult describe(RecoveryKind kind, const std::filesystem::path& source,
                        const std::filesystem::path& path, const session::Session& session,
                        std::uint64_t bytes_ignored) {
  return {.kind = kind,
          .source = source,
          .session = path,
          .state = session.state,
          .frames = session.frames.size(),
          .valid = valid_in(session),
          .chunks = chunks_of(session.raw),
          .bytes_ignored = bytes_ignored,
          .message = {},
          .removed = {}};
}

/// A session that was made before. Its journal, if it was kept, still knows what could not be read.
RecoveryResult already_there(const std::filesystem::path& source, const std::filesystem::path& session) {
  const std::uint64_t bytes_ignored = std::filesystem::exists(source) && journal::is_journal(source)
                                          ? journal::read_journal(source).bytes_ignored
                                          : 0;
  return describe(RecoveryKind::already_there, source, session, session::read_session(session),
                  bytes_ignored);
}

/// Is it `<session>.<process>.part`, as a session is called while it is written, of a process that is no
/// more?
bool is_abandoned_part(const std::filesystem::path& path, const std::filesystem::path& session) {
  const std::string name = path.filename().string();
  const std::string prefix = session.filename().string() + ".";
  constexpr std::string_view suffix = ".part";
  if (!name.starts_with(prefix) || !name.ends_with(suffix)) return false;
  pid_t process = 0;
  const char* const end = name.data() + name.size() - suffix.size();
  const auto [at, error] = std::from_chars(name.data() + prefix.size(), end, process);
  if (error != std::errc() || at != end || process <= 0) return false;
  return ::kill(process, 0) != 0 && errno == ESRCH;
}

/// The journal's lock is held: nobody else makes this session now.
std::vector<std::filesystem::path> remove_abandoned_parts(const std::filesystem::path& session) {
  std::vector<std::filesystem::path> removed;
  const auto folder = session.has_parent_path() ? session.parent_path() : std::filesystem::path(".");
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.is_regular_file() && is_abandoned_part(entry.path(), session)) removed.push_back(entry.path());
  std::sort(removed.begin(), removed.end());
  for (const auto& part : removed) std::filesystem::remove(part);
  return removed;
}

/// A torn tail stays on the disk, as it may interest somebody; a journal that was used up is removed.
RecoveryResult make_session(const std::filesystem::path& journal, const std::filesystem::path& session_path) {
  if (std::filesystem::exists(session_path)) return already_there(journal, session_path);
  journal::JournalContents contents = journal::read_journal(journal);
  const session::Session session = build_session(std::move(contents.recording));
  session::write_session(session_path, session);
  if (contents.bytes_ignored == 0) std::filesystem::remove(journal);
  return describe(RecoveryKind::made, journal, session_path, session, contents.bytes_ignored);
}

RecoveryResult recover_journal(const std::filesystem::path& journal) {
  const FileLock lock(journal, FileLock::Wait::no);
  if (!lock.is_held())
    return {
        .kind = RecoveryKind::in_use, .source = journal, .message = "is being recorded by another program"};
  std::vector<std::filesystem::path> removed = remove_abandoned_parts(session_of(journal));
  RecoveryResult result = make_session(journal, session_of(journal));
  result.removed = std::move(removed);
  return result;
}

RecoveryResult try_to_recover(const std::filesystem::path& journal) {
  try {
    return recover_journal(journal);
  } catch (const Error& error) {
    if (error.code() == ExitCode::storage) throw;  // every other journal would fail in the same way
    return {.kind = RecoveryKind::failed, .source = journal, .message = error.what_happened()};
  }
}

std::vector<std::filesystem::path> journals_below(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> journals;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().extension() == ".journal") journals.push_back(entry.path());
  std::sort(journals.begin(), journals.end());
  return journals;
}

}  // namespace

std::vector<RecoveryResult> recover(const std::filesystem::path& path) {
  std::vector<RecoveryResult> results;
  if (std::filesystem::is_directory(path)) {
    for (const auto& journal : journals_below(path)) results.push_back(try_to_recover(journal));
    return results;
  }
  const bool is_journal_name = path.extension() == ".journal";
  if (!std::filesystem::exists(path)) {
    if (is_journal_name && std::filesystem::exists(session_of(path)))
      return {already_there(path, session_of(path))};
    throw Error(ExitCode::bad_usage, "no such file or folder", path.string(),
                "the folder of the recordings, or a .journal file in it");
  }
  if (journal::is_journal(path) || is_journal_name) return {recover_journal(path)};
  return {already_there(path, path)};
}

}  // namespace thermorig::rig
