// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <new>
#include <optional>
#include <string_view>

#include "thermorig/core/error.h"
#include "thermorig/io/files/holder.h"
#include "thermorig/io/files/part_file.h"
#include "thermorig/io/spill/spill.h"
#include "thermorig/rig/recording/finalise.h"
#include "thermorig/rig/recording/session_file.h"
#include "thermorig/storage/journal/journal.h"
#include "thermorig/storage/session/annotations.h"
#include "thermorig/storage/session/salvage.h"

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
          .message = {}};
}

bool is_there(const std::filesystem::path& path, files::Disk& disk) {
  const auto there = disk.look(path);
  if (!there.good())
    throw Error(ExitCode::storage, std::string("cannot be accessed: ") + std::strerror(there.error_number),
                path.string(), "check its permissions and the disk (dmesg)");
  return there.value != files::FileKind::missing;
}

/// A session that was made before. Its journal, if it was kept, still knows what could not be read.
RecoveryResult already_there(const std::filesystem::path& source, const std::filesystem::path& session,
                             files::Disk& disk) {
  spill::arrays_near(session);
  const std::uint64_t bytes_ignored = is_there(source, disk) && journal::is_journal(source, disk)
                                          ? journal::read_journal(source, disk).bytes_ignored
                                          : 0;
  return describe(RecoveryKind::already_there, source, session, stored_session(session, disk), bytes_ignored);
}

/// Of a session that was cut short another one is made, of what it still holds.
RecoveryResult salvage_session(const std::filesystem::path& path, const session::StoredFile& file,
                               files::Disk& disk) {
  std::filesystem::path salvaged = path;
  salvaged.replace_filename(path.stem().string() + "_salvaged.h5");
  const bool is_made = is_there(salvaged, disk);
  session::Salvaged left = session::salvage(file);
  session::Session session;
  if (is_made) {
    session = stored_session(salvaged, disk);
  } else {
    session = build_session(std::move(left.raw));
    session.annotations = std::move(left.annotations);
    session::apply_exclusions(session);
    session::write_session(salvaged, session, disk);
  }
  RecoveryResult result = describe(is_made ? RecoveryKind::already_there : RecoveryKind::made, path, salvaged,
                                   session, left.bytes_missing);
  result.of_cut_session = true;
  return result;
}

std::vector<files::FolderEntry> entries_of(const std::filesystem::path& folder, files::Disk& disk) {
  auto entries = disk.list(folder);
  if (!entries.good())
    throw Error(ExitCode::storage,
                std::string("the folder cannot be read: ") + std::strerror(entries.error_number),
                folder.string(), "check its permissions and the disk (dmesg)");
  std::sort(entries.value.begin(), entries.value.end(),
            [](const auto& a, const auto& b) { return a.path < b.path; });
  return std::move(entries.value);
}

/// What killed programs left of files that they were writing: of `only`, or of any in the folder. Removed
/// before anything is written, as it may be what fills the disk.
std::vector<RecoveryResult> remove_left_parts(const std::vector<files::FolderEntry>& entries,
                                              files::Disk& disk,
                                              const std::optional<std::filesystem::path>& only = {}) {
  std::vector<RecoveryResult> removed;
  for (const files::FolderEntry& entry : entries) {
    const auto left_of = files::left_part_of(entry.path);
    if (entry.kind != files::FileKind::file || !left_of || (only && *left_of != *only)) continue;
    if (!files::remove_unless_held(entry.path, disk)) continue;  // litter harms nobody
    removed.push_back({.kind = RecoveryKind::left_part,
                       .source = entry.path,
                       .message = "a killed program left it behind, half written: removed"});
  }
  return removed;
}

void append(std::vector<RecoveryResult>& results, std::vector<RecoveryResult> more) {
  results.insert(results.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

RecoveryResult remove_empty(const std::filesystem::path& journal, bool is_ours, files::Disk& disk) {
  if (!is_ours)
    return {.kind = RecoveryKind::in_use,
            .source = journal,
            .message =
                "it is empty, and this file system does not show whether a program uses it: left as it is"};
  retire_journal(journal, disk);
  return {.kind = RecoveryKind::empty,
          .source = journal,
          .message = "it is empty (its program ended before it recorded): removed"};
}

/// `is_ours`: nobody is still writing the journal.
RecoveryResult make_session(const std::filesystem::path& journal, const std::filesystem::path& session_path,
                            bool is_ours, files::Disk& disk) {
  if (is_there(session_path, disk)) return already_there(journal, session_path, disk);
  if (journal::holds_nothing(journal, disk)) return remove_empty(journal, is_ours, disk);
  const Finalised made =
      finalise(journal, session_path, disk, is_ours ? WithoutEnd::retire : WithoutEnd::keep);
  return describe(RecoveryKind::made, journal, session_path, made.session, made.bytes_ignored);
}

/// Its own recorder has finished or discarded it since it was found.
std::optional<RecoveryResult> gone(const std::filesystem::path& journal, files::Disk& disk) {
  const std::filesystem::path session = session_of(journal);
  if (!is_there(session, disk)) return std::nullopt;
  return already_there(journal, session, disk);
}

/// None if the journal is not there any more, and no session of it.
std::optional<RecoveryResult> recover_journal(const std::filesystem::path& journal, files::Disk& disk) {
  // A recorder holds its folder from the choice of a name until its journal is locked.
  std::optional<files::FileLock> folder(std::in_place, files::folder_of(journal), files::FileLock::Wait::yes,
                                        disk);
  std::optional<files::FileLock> lock;
  try {
    lock.emplace(journal, files::FileLock::Wait::no, disk);
  } catch (const Error&) {
    if (is_there(journal, disk)) throw;
    return gone(journal, disk);
  }
  const bool is_ours = folder->is_certain() && lock->is_certain();
  folder.reset();
  if (!lock->is_held())
    return RecoveryResult{
        .kind = RecoveryKind::in_use, .source = journal, .message = "is being recorded by another program"};
  if (!is_there(journal, disk)) return gone(journal, disk);  // what was locked has no name any more
  return make_session(journal, session_of(journal), is_ours, disk);
}

RecoveryResult failed(const std::filesystem::path& source, const Error& error) {
  std::string message = error.what_happened();
  if (error.code() == ExitCode::storage) {
    if (error.where() != source.string()) message = error.where() + ": " + message;
    message += "; " + error.advice();
  }
  return {
      .kind = RecoveryKind::failed, .source = source, .message = std::move(message), .code = error.code()};
}

/// Whatever fails of one journal keeps nobody from the others.
std::optional<RecoveryResult> try_to_recover(const std::filesystem::path& journal, files::Disk& disk) {
  try {
    return recover_journal(journal, disk);
  } catch (const Error& error) {
    return failed(journal, error);
  } catch (const std::bad_alloc&) {
    return failed(journal,
                  Error(ExitCode::failed, "not enough memory to make its session", journal.string(), ""));
  } catch (const std::exception& error) {
    return failed(journal, Error(ExitCode::failed, error.what(), journal.string(), ""));
  }
}

void recover_all(const std::filesystem::path& folder, files::Disk& disk,
                 std::vector<RecoveryResult>& results) {
  std::vector<files::FolderEntry> entries;
  try {
    entries = entries_of(folder, disk);
  } catch (const Error& error) {  // e.g. lost+found
    results.push_back(failed(folder, error));
  }
  std::vector<RecoveryResult> removed = remove_left_parts(entries, disk);
  for (const files::FolderEntry& entry : entries) {
    if (entry.kind == files::FileKind::folder) recover_all(entry.path, disk, results);
    if (entry.kind != files::FileKind::file || entry.path.extension() != ".journal") continue;
    if (auto result = try_to_recover(entry.path, disk)) results.push_back(std::move(*result));
  }
  append(results, std::move(removed));
}

}  // namespace

std::vector<RecoveryResult> recover(const std::filesystem::path& path, files::Disk& disk) {
  const auto there = disk.look(path);
  if (there.good() && there.value == files::FileKind::folder) {
    std::vector<RecoveryResult> results;
    recover_all(path, disk, results);
    return results;
  }
  const bool is_journal_name = path.extension() == ".journal";
  if (!is_there(path, disk)) {
    if (is_journal_name && is_there(session_of(path), disk))
      return {already_there(path, session_of(path), disk)};
    throw Error(ExitCode::bad_usage, "no such file or folder", path.string(),
                "the folder of the recordings, or a .journal file in it");
  }
  if (is_journal_name || journal::is_journal(path, disk)) {
    std::vector<RecoveryResult> removed =
        remove_left_parts(entries_of(files::folder_of(path), disk), disk, session_of(path));
    std::vector<RecoveryResult> results;
    if (auto result = recover_journal(path, disk)) results.push_back(std::move(*result));
    append(results, std::move(removed));
    return results;
  }
  if (const session::StoredFile file(disk, path); session::is_cut_short(file))
    return {salvage_session(path, file, disk)};
  return {already_there(path, path, disk)};
}

std::vector<std::filesystem::path> left_parts(const std::filesystem::path& folder, files::Disk& disk) {
  std::vector<std::filesystem::path> parts;
  for (const files::FolderEntry& entry : disk.list(folder).value) {
    if (entry.kind == files::FileKind::folder) {
      const auto below = left_parts(entry.path, disk);
      parts.insert(parts.end(), below.begin(), below.end());
    } else if (entry.kind == files::FileKind::file && files::left_part_of(entry.path)) {
      parts.push_back(entry.path);
    }
  }
  return parts;
}

}  // namespace thermorig::rig
