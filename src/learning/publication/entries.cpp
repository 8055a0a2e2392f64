// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <tuple>

#include "folder_file.h"
#include "sha256.h"
#include "thermorig/core/code_point.h"
#include "thermorig/core/error.h"
#include "thermorig/learning/publication/publication.h"

namespace thermorig::publication {

namespace {

namespace fs = std::filesystem;
using dataset::ListedSession;

/// JSON, YAML and `sha256sum -c` shall read the same name.
void require_listable(const FolderPath& found, const fs::path& folder) {
  const std::string& path = found.path;
  const bool is_simple = std::none_of(path.begin(), path.end(),
                                      [](char c) { return (c >= 0 && c < ' ') || c == '\\' || c == 127; });
  if (is_simple && is_utf8(path)) return;
  throw Error(ExitCode::bad_usage, "its name cannot stand in a list of check sums", (folder / path).string(),
              "give it a name of UTF-8 without control characters and backslashes");
}

/// Throws Error for what verify() would not take.
void require_taken(const FolderPath& found, const fs::path& folder) {
  if (!found.problem.empty())
    throw Error(ExitCode::not_a_session, "a data set is made of files: " + found.path + " " + found.problem,
                (folder / found.path).string(), "move it out of the folder");
  require_listable(found, folder);
}

/// Its facts and its sum are of the same file.
session::StoredFile opened(const fs::path& folder, const std::string& path, Entry& entry) {
  const auto file = std::make_shared<const FolderFile>(folder, path);
  if (!file->problem().empty()) require_taken({path, file->problem()}, folder);
  entry.path = path;
  entry.bytes = file->bytes();
  entry.sha256 = file->sha256();
  const auto read_at = [file](std::uint64_t offset, std::span<std::byte> out) { file->read(offset, out); };
  return session::StoredFile(file->bytes(), read_at, folder / path);
}

void require_sessions(const std::vector<ListedSession>& sessions, bool accept_bad) {
  std::map<std::string, const ListedSession*> seen;
  for (const ListedSession& session : sessions) {
    if (session.refusal) throw *session.refusal;
    if (session.quality.verdict == "bad" && !accept_bad)
      throw Error(
          ExitCode::check_failed,
          fmt::format("the session's verdict is bad: {}", fmt::join(session.quality.verdict_reasons, "; ")),
          session.file.string(), "move it out of the folder, or take it as it is: --accept-bad");
    const auto [first, is_new] = seen.emplace(session.header.uuid, &session);
    if (!is_new)
      throw Error(ExitCode::not_a_session, "holds the same recording as " + first->second->file.string(),
                  session.file.string(), "keep one of the two only");
  }
}

bool is_before(const Entry& one, const Entry& other) {
  const auto place = [](const Entry& entry) {
    return std::tie(entry.session.place.environment, entry.session.place.acquisition, entry.path);
  };
  return place(one) < place(other);
}

}  // namespace

std::vector<Entry> entries_of(const fs::path& folder, bool accept_bad,
                              const dataset::ReadingProgress& progress) {
  const std::vector<FolderPath> found = sessions_in(folder);
  if (found.empty()) dataset::find_sessions({folder});  // says what to do
  std::vector<fs::path> files;
  for (const FolderPath& one : found) {
    require_taken(one, folder);
    files.push_back(folder / one.path);
  }
  std::vector<Entry> entries(files.size());
  std::vector<ListedSession> sessions = dataset::list_sessions(
      files, progress, [&](std::size_t index) { return opened(folder, found[index].path, entries[index]); });
  require_sessions(sessions, accept_bad);
  for (std::size_t i = 0; i < entries.size(); ++i) entries[i].session = std::move(sessions[i]);
  std::sort(entries.begin(), entries.end(), is_before);
  return entries;
}

std::vector<Fold> leave_one_out(const std::vector<Entry>& entries) {
  std::set<std::string> environments;
  for (const Entry& entry : entries)
    if (!entry.session.for_calibration) environments.insert(entry.session.place.environment);
  std::vector<Fold> folds;
  if (environments.size() < 2) return folds;
  for (const std::string& environment : environments) {
    Fold& fold = folds.emplace_back(Fold{environment, {}, {}});
    for (const Entry& entry : entries) {
      if (entry.session.for_calibration) continue;
      (entry.session.place.environment == environment ? fold.test : fold.training).push_back(entry.path);
    }
  }
  return folds;
}

std::string licence_of(const Terms& terms, const std::vector<Entry>& entries) {
  if (!terms.licence.empty()) return terms.licence;
  std::set<std::string> licences;
  for (const Entry& entry : entries) licences.insert(entry.session.header.licence);
  return licences.size() == 1 ? *licences.begin() : "";
}

}  // namespace thermorig::publication
