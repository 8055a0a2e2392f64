// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

#include "folder_file.h"
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
  throw Error(ExitCode::not_a_session, fmt::format("is not a list of check sums, by its line \"{}\"", line),
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

std::string sums_of(const fs::path& folder) {
  const FolderFile file(folder, sums_name);
  const fs::path path = folder / sums_name;
  if (file.is_missing())
    throw Error(ExitCode::bad_usage, "the folder has no check sums of a data set", path.string(),
                "thermorig dataset build " + shell_word(folder.string()) + " --title TEXT");
  if (!file.problem().empty())
    throw Error(ExitCode::not_a_session, "the list of check sums " + file.problem(), path.string(),
                "take it from where the data set came from");
  if (file.bytes() > bytes_max) refuse_sums(path, "of more than 64 MiB");
  std::string text(file.bytes(), '\0');
  file.read(0, std::as_writable_bytes(std::span(text)));
  return text;
}

/// By path.
std::map<std::string, std::string> read_sums(const fs::path& folder) {
  const fs::path path = folder / sums_name;
  std::istringstream text(sums_of(folder));
  std::map<std::string, std::string> sums;
  for (std::string line; std::getline(text, line);) {
    const std::size_t behind = digits + 2;  // two blanks
    if (line.size() <= behind || line.substr(digits, 2) != "  " || !is_sum(line.substr(0, digits)) ||
        !is_within_folder(line.substr(behind)) ||
        !sums.emplace(line.substr(behind), line.substr(0, digits)).second)  // a file that is there twice
      refuse_sums(path, line.substr(0, digits + 64));
  }
  return sums;
}

/// Nothing if the file is as it was.
std::string change_of(const fs::path& folder, const std::string& path, const std::string& sum) {
  const FolderFile file(folder, path);
  if (!file.problem().empty()) return file.problem();
  return file.sha256() == sum ? "" : "has other bytes than when the data set was built";
}

std::string unlisted_text(const std::string& path) {
  const bool is_description =
      std::find(description_names.begin(), description_names.end(), path) != description_names.end();
  return is_description ? "has no line in " + std::string(sums_name) : "is not of the data set";
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
  const std::vector<FolderPath> found = sessions_in(folder);
  std::map<std::string, std::string> sums = read_sums(folder);
  std::set<std::string> paths(description_names.begin(), description_names.end());
  for (const FolderPath& session : found) paths.insert(session.path);
  std::vector<Difference> differences;
  for (const auto& [path, sum] : sums)
    if (std::string change = change_of(folder, path, sum); !change.empty())
      differences.push_back({path, std::move(change)});
    else if (!paths.contains(path))
      differences.push_back({path, "is neither a session nor a description of the data set"});
  for (const std::string& path : paths)
    if (!sums.contains(path)) differences.push_back({path, unlisted_text(path)});
  return differences;
}

}  // namespace thermorig::publication
