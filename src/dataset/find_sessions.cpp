// SPDX-License-Identifier: MIT
#include <algorithm>
#include <set>

#include "thermorig/core/error.h"
#include "thermorig/dataset/dataset.h"

namespace thermorig::dataset {

namespace {

namespace fs = std::filesystem;

/// Files by what they really are, so that one that is reached on two ways counts once.
class FoundFiles {
 public:
  void add(const fs::path& path) {
    std::error_code failure;
    const fs::path real = fs::canonical(path, failure);
    if (seen_.insert(failure ? path : real).second) files_.push_back(path);
  }

  std::vector<fs::path> sorted() {
    std::sort(files_.begin(), files_.end());
    return files_;
  }

 private:
  std::set<fs::path> seen_;
  std::vector<fs::path> files_;
};

[[noreturn]] void refuse_folder(const fs::path& folder, const std::string& why) {
  throw Error(ExitCode::bad_usage, "the folder cannot be searched: " + why, folder.string(),
              "change its permissions, or name the session files themselves");
}

void search(const fs::path& folder, FoundFiles& found) {
  std::error_code failure;
  fs::recursive_directory_iterator entry(folder, failure);
  for (; !failure && entry != fs::recursive_directory_iterator(); entry.increment(failure)) {
    std::error_code broken_link;
    if (entry->path().extension() == ".h5" && entry->is_regular_file(broken_link)) found.add(entry->path());
  }
  if (failure) refuse_folder(folder, failure.message());
}

void add_path(const fs::path& path, FoundFiles& found) {
  std::error_code hidden;  // where a folder may not be searched, opening says so
  const fs::file_status status = fs::status(path, hidden);
  if (status.type() == fs::file_type::not_found)
    throw Error(ExitCode::bad_usage, "there is no such file or folder", path.string(),
                "check the name: ls recordings/*");
  if (fs::is_directory(status))
    search(path, found);
  else
    found.add(path);
}

}  // namespace

std::vector<fs::path> find_sessions(const std::vector<fs::path>& paths) {
  FoundFiles found;
  for (const fs::path& path : paths) add_path(path, found);
  std::vector<fs::path> files = found.sorted();
  if (files.empty())
    throw Error(ExitCode::bad_usage, "there is no session (.h5) in it",
                paths.empty() ? "" : paths.front().string(),
                "record some: thermorig record --simulated --fast --environment garden --plan table-one");
  return files;
}

}  // namespace thermorig::dataset
