// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>

#include "sha256.h"
#include "thermorig/core/error.h"
#include "thermorig/core/printable.h"
#include "thermorig/learning/publication/publication.h"

namespace thermorig::publication {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t digits = 64;
constexpr std::size_t bytes_max = 64U << 20U;

[[noreturn]] void refuse_sums(const fs::path& path, const std::string& line) {
  throw Error(ExitCode::not_a_session, fmt::format("is no list of check sums, by its line \"{}\"", line),
              path.string(), "take it from where the data set came from");
}

/// A stranger's list may name any file: only those in the folder are looked at. What stands behind a NUL the
/// system would not see.
bool is_within_folder(const fs::path& path) {
  return !path.empty() && path.is_relative() && path.native().find('\0') == std::string::npos &&
         std::none_of(path.begin(), path.end(), [](const fs::path& part) { return part == ".."; });
}

bool is_sum(const std::string& text) {
  return text.size() == digits && std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
         });
}

/// By path.
std::map<std::string, std::string> read_sums(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw Error(ExitCode::bad_usage, "the folder has no check sums of a data set", path.string(),
                "thermorig dataset build " + shell_word(path.parent_path().string()) + " --title TEXT");
  if (fs::file_size(path) > bytes_max) refuse_sums(path, "of more than 64 MiB");
  std::map<std::string, std::string> sums;
  for (std::string line; std::getline(file, line);) {
    const std::size_t behind = digits + 2;  // two blanks
    if (line.size() <= behind || line.substr(digits, 2) != "  " || !is_sum(line.substr(0, digits)) ||
        !is_within_folder(line.substr(behind)) ||
        !sums.emplace(line.substr(behind), line.substr(0, digits)).second)  // a file that is there twice
      refuse_sums(path, line.substr(0, digits + 64));
  }
  return sums;
}

/// Nothing if the file is as it was.
std::string change_of(const fs::path& path, const std::string& sum) {
  std::error_code hidden;
  const fs::file_status status = fs::status(path, hidden);
  if (status.type() == fs::file_type::not_found) return "is missing";
  if (!fs::is_regular_file(status)) return "is no file";
  return sha256_of_file(path) == sum ? "" : "has other bytes than when the data set was built";
}

}  // namespace

std::string sums_text(const std::vector<Entry>& entries, const std::vector<Description>& descriptions) {
  std::map<std::string, std::string> sums;
  for (const Entry& entry : entries) sums[entry.path] = entry.sha256;
  for (const Description& description : descriptions) sums[description.name] = sha256_of(description.text);
  std::string text;
  for (const auto& [path, sum] : sums) text += fmt::format("{}  {}\n", sum, path);
  return text;
}

std::vector<Difference> verify(const fs::path& folder) {
  const std::map<std::string, std::string> sums = read_sums(folder / sums_name);
  std::vector<Difference> differences;
  for (const auto& [path, sum] : sums)
    if (std::string change = change_of(folder / path, sum); !change.empty())
      differences.push_back({path, std::move(change)});
  std::error_code failure;
  for (fs::recursive_directory_iterator entry(folder, failure), end; !failure && entry != end;
       entry.increment(failure)) {
    const std::string path = entry->path().lexically_relative(folder).generic_string();
    if (entry->path().extension() == ".h5" && !sums.contains(path))
      differences.push_back({path, "is not of the data set"});
  }
  if (failure)
    throw Error(ExitCode::storage, "the folder cannot be searched: " + failure.message(), folder.string(),
                "change its permissions");
  return differences;
}

}  // namespace thermorig::publication
