// SPDX-License-Identifier: MIT
#include <algorithm>
#include <set>

#include "thermorig/core/error.h"
#include "thermorig/io/files/existing.h"
#include "thermorig/learning/dataset/dataset.h"

namespace thermorig::dataset {

namespace {

namespace fs = std::filesystem;

/// Sorted; of a file that is reached on two ways the first name stays.
std::vector<fs::path> each_once(std::vector<fs::path> files) {
  std::sort(files.begin(), files.end());
  std::set<fs::path> seen;
  std::erase_if(files, [&](const fs::path& path) {
    std::error_code failure;
    const fs::path real = fs::canonical(path, failure);
    return !seen.insert(failure ? path : real).second;
  });
  return files;
}

[[noreturn]] void refuse_folder(const fs::path& folder, const std::string& why) {
  throw Error(ExitCode::bad_usage, "the folder cannot be searched: " + why, folder.string(),
              "change its permissions, or name the session files themselves");
}

/// What lies in the folders: sessions, and journals that wait to be made some.
struct Found {
  std::vector<fs::path> sessions, journals;
};

void search(const fs::path& folder, Found& found) {
  std::error_code failure;
  fs::recursive_directory_iterator entry(folder, failure);
  for (; !failure && entry != fs::recursive_directory_iterator(); entry.increment(failure)) {
    std::error_code broken_link;
    if (!entry->is_regular_file(broken_link)) continue;
    if (entry->path().extension() == ".h5") found.sessions.push_back(entry->path());
    if (entry->path().extension() == ".journal") found.journals.push_back(entry->path());
  }
  if (failure) refuse_folder(folder, failure.message());
}

void add_path(const fs::path& path, Found& found) {
  files::require_existing(path);
  std::error_code hidden;  // where a folder may not be searched, opening says so
  if (fs::is_directory(path, hidden))
    search(path, found);
  else
    found.sessions.push_back(path);
}

Found found_at(const std::vector<fs::path>& paths) {
  Found found;
  for (const fs::path& path : paths) add_path(path, found);
  return found;
}

[[noreturn]] void refuse_without_sessions(const fs::path& place, const std::vector<fs::path>& journals) {
  throw Error(
      ExitCode::bad_usage,
      journals.empty() ? "there is no session (.h5) in it"
                       : "it holds no session (.h5), but a journal that recover makes one of",
      place.string(),
      journals.empty()
          ? "record some: thermorig record --simulated --fast --environment garden --plan table-one"
          : "thermorig recover " + shell_word(std::min_element(journals.begin(), journals.end())->string()));
}

}  // namespace

std::vector<fs::path> find_sessions(const std::vector<fs::path>& paths) {
  Found found = found_at(paths);
  if (found.sessions.empty()) refuse_without_sessions(paths.empty() ? "" : paths.front(), found.journals);
  return each_once(std::move(found.sessions));
}

std::vector<fs::path> find_journals(const std::vector<fs::path>& paths) {
  return each_once(found_at(paths).journals);
}

}  // namespace thermorig::dataset
