// SPDX-License-Identifier: MIT
#include "thermorig/rig/session_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "file_lock.h"
#include "thermorig/core/error.h"

namespace thermorig::rig {

namespace {

constexpr std::size_t environment_length_max = 32;

bool is_allowed(char character) {
  return (character >= 'a' && character <= 'z') || (character >= '0' && character <= '9') || character == '-';
}

[[noreturn]] void refuse_folder(const std::filesystem::path& folder, const std::string& why) {
  throw Error(ExitCode::storage, "the output folder cannot be written: " + why, folder.string(),
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

FolderLock::FolderLock(const std::filesystem::path& output, const std::string& environment)
    : environment_(environment) {
  check_environment(environment);
  folder_ = output / environment;
  std::error_code failure;
  for (auto folder = folder_; !folder.empty() && !std::filesystem::exists(folder, failure);
       folder = folder.parent_path())
    made_folders_.push_back(folder);
  std::filesystem::create_directories(folder_, failure);
  if (failure) refuse_folder(folder_, failure.message());
  if (::access(folder_.c_str(), W_OK | X_OK) != 0)
    refuse_folder(folder_, "no permission to create files in it");
  lock_ = std::make_unique<FileLock>(folder_, FileLock::Wait::yes);
}

FolderLock::~FolderLock() = default;

SessionFile FolderLock::next(const std::string& utc_compact) const {
  int highest = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_))
    highest = std::max(highest, number_in(entry.path().filename().string(), environment_));
  const int number = highest + 1;
  const auto stem = folder_ / fmt::format("{}_acq-{:02}_{}", environment_, number, utc_compact);
  return {.acquisition = number,
          .session = stem.string() + ".h5",
          .journal = stem.string() + ".journal",
          .made_folders = made_folders_};
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

}  // namespace thermorig::rig
