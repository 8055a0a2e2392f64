// SPDX-License-Identifier: MIT
#include "thermorig/rig/recording/session_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <string_view>

#include "thermorig/core/error.h"

namespace thermorig::rig {

namespace {

constexpr std::size_t environment_length_max = 32;

bool is_allowed(char character) {
  return (character >= 'a' && character <= 'z') || (character >= '0' && character <= '9') || character == '-';
}

[[noreturn]] void refuse_folder(const std::filesystem::path& folder, const char* action, int error_number) {
  throw Error(ExitCode::storage, fmt::format("{}: {}", action, std::strerror(error_number)), folder.string(),
              "choose another one with --output, or change its permissions");
}

/// The number in "<environment>_acq-<nn>_...", 0 if the name is not of that form.
int number_in(std::string_view name, std::string_view environment) {
  const std::string prefix = fmt::format("{}_acq-", environment);
  if (!name.starts_with(prefix)) return 0;
  name.remove_prefix(prefix.size());
  int number = 0;
  const auto end = std::from_chars(name.data(), name.data() + name.size(), number).ptr;
  const bool whole = end != name.data() + name.size() && *end == '_';
  return whole ? std::max(0, number) : 0;
}

}  // namespace

void check_environment(const std::string& environment) {
  const bool good = !environment.empty() && environment.size() <= environment_length_max &&
                    std::all_of(environment.begin(), environment.end(), is_allowed);
  if (good) return;
  throw Error(ExitCode::bad_usage, fmt::format("\"{}\" cannot be the name of an environment", environment),
              "--environment",
              fmt::format("1 to {} characters of a-z, 0-9 and '-', e.g. kitchen or dining-place",
                          environment_length_max));
}

FolderLock::FolderLock(const std::filesystem::path& output, const std::string& environment, files::Disk& disk)
    : disk_(disk), environment_(environment) {
  check_environment(environment);
  folder_ = output / environment;
  make_folders();
  lock_ = std::make_unique<files::FileLock>(folder_, files::FileLock::Wait::yes, disk);
}

FolderLock::~FolderLock() = default;

void FolderLock::make_folders() {
  for (auto folder = folder_; !folder.empty(); folder = folder.parent_path()) {
    const auto there = disk_.look(folder);
    if (!there.good()) refuse_folder(folder, "the output folder cannot be accessed", there.error_number);
    if (there.value != files::FileKind::missing) break;
    made_folders_.push_back(folder);
  }
  for (auto folder = made_folders_.rbegin(); folder != made_folders_.rend(); ++folder) {
    const int made = disk_.make_folder(*folder);
    if (made != 0 && made != EEXIST) refuse_folder(*folder, "the output folder cannot be written", made);
    const int synced = disk_.sync_folder(files::folder_of(*folder));
    if (synced != 0) refuse_folder(*folder, "the output folder cannot be synced", synced);
  }
}

SessionFile FolderLock::next(const std::string& utc_compact) const {
  int highest = 0;
  const auto entries = disk_.list(folder_);
  if (!entries.good()) refuse_folder(folder_, "the output folder cannot be read", entries.error_number);
  for (const files::FolderEntry& entry : entries.value)
    highest = std::max(highest, number_in(entry.path.filename().string(), environment_));
  const int number = highest + 1;
  const auto stem = folder_ / fmt::format("{}_acq-{:02}_{}", environment_, number, utc_compact);
  return {.acquisition = number,
          .session = stem.string() + ".h5",
          .journal = stem.string() + ".journal",
          .made_folders = made_folders_};
}

SessionFile dated(const SessionFile& file, const std::string& utc_compact, files::Disk& disk) {
  const std::string stem = file.session.stem().string();
  const auto renamed = file.session.parent_path() / (stem.substr(0, stem.rfind('_') + 1) + utc_compact);
  SessionFile result = file;
  result.session = renamed.string() + ".h5";
  result.journal = renamed.string() + ".journal";
  return disk.rename(file.journal, result.journal) == 0 ? result : file;
}

std::string compact_utc(const std::string& utc) {
  std::string compact = utc.substr(0, utc.find('.'));
  std::erase_if(compact,
                [](char character) { return character == '-' || character == ':' || character == 'Z'; });
  return compact + "Z";
}

std::filesystem::path session_of(const std::filesystem::path& journal) {
  std::filesystem::path session = journal;
  return session.replace_extension(".h5");
}

session::Session stored_session(const std::filesystem::path& path, files::Disk& disk) {
  return session::read_session(session::StoredFile(disk, path));
}

void retire_journal(const std::filesystem::path& journal, files::Disk& disk) {
  const int removed = disk.remove(journal);
  if (removed == 0 || removed == ENOENT) return;
  throw Error(
      ExitCode::storage,
      std::string("the session is complete, but its journal cannot be removed: ") + std::strerror(removed),
      journal.string(), "check the disk (dmesg), then remove the journal");
}

}  // namespace thermorig::rig
