// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "sha256.h"
#include "thermorig/core/error.h"
#include "thermorig/learning/publication/publication.h"

namespace thermorig::publication {

namespace {

namespace fs = std::filesystem;
using dataset::ListedSession;

std::string path_within(const fs::path& folder, const fs::path& file) {
  std::string path = file.lexically_relative(folder).generic_string();
  const bool is_simple = std::none_of(path.begin(), path.end(),
                                      [](char c) { return (c >= 0 && c < ' ') || c == '\\' || c == 127; });
  if (is_simple && !path.empty()) return path;
  throw Error(ExitCode::bad_usage, "its name cannot stand in a list of check sums", file.string(),
              "give it a name without control characters and backslashes");
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
  std::vector<ListedSession> sessions = dataset::list_sessions(dataset::find_sessions({folder}), progress);
  require_sessions(sessions, accept_bad);
  std::vector<Entry> entries;
  for (ListedSession& session : sessions) {
    Entry entry;
    entry.path = path_within(folder, session.file);
    entry.sha256 = sha256_of_file(session.file);
    entry.bytes = fs::file_size(session.file);
    entry.session = std::move(session);
    entries.push_back(std::move(entry));
  }
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
