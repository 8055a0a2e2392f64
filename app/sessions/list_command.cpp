// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "commands.h"
#include "print/annotation_text.h"
#include "print/error_output.h"
#include "print/inspect_text.h"
#include "print/number_json.h"
#include "print/output.h"
#include "print/reading_progress.h"
#include "print/terminal_width.h"
#include "thermorig/io/spill/spill.h"
#include "thermorig/learning/dataset/session_list.h"

namespace thermorig::app {

namespace {

using dataset::ListedSession;

bool is_among(const std::vector<std::string>& wanted, const std::string& word) {
  return wanted.empty() || std::find(wanted.begin(), wanted.end(), word) != wanted.end();
}

/// A file that could not be read may be any of them.
bool is_wanted(const ListOptions& options, const ListedSession& session) {
  const RecordingHeader& header = session.header;
  return session.refusal ||
         (is_among(options.environments, session.place.environment) &&
          is_among(options.plans, header.plan_name) && is_among(options.verdicts, session.quality.verdict) &&
          !(options.simulated && !header.simulated) && !(options.real && header.simulated));
}

std::size_t rank_of(const std::string& verdict) {
  static constexpr std::array<std::string_view, 3> worst_first{"bad", "usable", "good"};
  return static_cast<std::size_t>(std::find(worst_first.begin(), worst_first.end(), verdict) -
                                  worst_first.begin());
}

bool is_before(const std::string& sort, const ListedSession& one, const ListedSession& other) {
  const auto place = [](const ListedSession& session) {
    return std::tie(session.place.environment, session.place.acquisition, session.header.start_time_utc,
                    session.file);
  };
  if (sort == "date" && one.header.start_time_utc != other.header.start_time_utc)
    return one.header.start_time_utc < other.header.start_time_utc;
  if (sort == "verdict" && one.quality.verdict != other.quality.verdict)
    return rank_of(one.quality.verdict) < rank_of(other.quality.verdict);
  if (sort == "valid" && one.quality.valid != other.quality.valid)
    return one.quality.valid < other.quality.valid;
  return place(one) < place(other);
}

/// Nobody shall take a word that fits nothing for an empty folder. Empty if something fits.
std::string none_text(const ListOptions& options, const std::vector<ListedSession>& all) {
  const auto is_one = [&](const ListedSession& session) { return is_wanted(options, session); };
  if (std::any_of(all.begin(), all.end(), is_one)) return "";
  std::set<std::string> environments, plans;
  for (const ListedSession& session : all) {
    environments.insert(printable(session.place.environment));
    plans.insert(printable(session.header.plan_name));
  }
  return fmt::format("none of the {} session{} there is what was asked for: environments {}; plans {}\n",
                     count_text(all.size()), all.size() == 1 ? "" : "s", fmt::join(environments, ", "),
                     fmt::join(plans, ", "));
}

/// Those that are asked for, in order; what is no session comes last.
std::vector<ListedSession> chosen_of(const ListOptions& options, std::vector<ListedSession> all) {
  std::erase_if(all, [&](const ListedSession& session) { return !is_wanted(options, session); });
  const auto refused = std::stable_partition(all.begin(), all.end(),
                                             [](const ListedSession& session) { return !session.refusal; });
  std::sort(all.begin(), refused, [&](const ListedSession& one, const ListedSession& other) {
    return options.reverse ? is_before(options.sort, other, one) : is_before(options.sort, one, other);
  });
  return all;
}

/// "hard" of "hard,gyro.bandwidth_hz=20,...".
std::string rig_text(const ListedSession& session) {
  if (!session.header.simulated) return "real";
  const std::string world = dataset::world_of(session.header);
  return world.empty() ? "SIMULATED" : "SIMULATED " + world.substr(0, world.find(','));
}

/// To the minute, as people look for it: "2026-11-23 19:42".
std::string date_text(const std::string& start_time_utc) {
  constexpr std::size_t up_to_minutes = 16;
  std::string text = start_time_utc.substr(0, up_to_minutes);
  std::replace(text.begin(), text.end(), 'T', ' ');
  return text;
}

/// Exclusions first: who trains looks for what is missing.
std::string notes_text(const ListedSession& session) {
  constexpr std::size_t most = 48;
  std::vector<std::string> notes;
  for (const Annotation& exclusion : session.exclusions) notes.push_back(exclusion_text(exclusion));
  notes.insert(notes.end(), session.notes.begin(), session.notes.end());
  std::string text = printable(fmt::format("{}", fmt::join(notes, "; ")));
  if (text.size() <= most) return text;
  std::size_t end = most - 3;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;  // within a character
  return text.substr(0, end) + "...";
}

Table table_of(const std::vector<ListedSession>& sessions) {
  Table table({"environment", ">number", "date (UTC)", "plan", "verdict", "rig", ">valid", ">in legs", "file",
               "notes"});
  for (const ListedSession& session : sessions) {
    if (session.refusal) continue;
    const RecordingHeader& header = session.header;
    table.add({session.place.environment, std::to_string(session.place.acquisition),
               date_text(header.start_time_utc), header.plan_name, session.quality.verdict, rig_text(session),
               count_text(session.quality.valid), count_text(session.quality.swept), session.file.string(),
               notes_text(session)});
  }
  return table;
}

/// A line of its own below each session's.
std::string with_files(const std::string& table, const std::vector<ListedSession>& sessions) {
  std::istringstream lines(table);
  std::string line, text;
  std::getline(lines, line);  // the heading
  text += line + "\n";
  for (const ListedSession& session : sessions)
    if (!session.refusal && std::getline(lines, line))
      text += line + "\n  " + printable(session.file.string()) + "\n";
  return text;
}

/// What a terminal has no room for is left out, and named; of the file, which is what one goes on with, there
/// is a line of its own.
void print_table(const std::vector<ListedSession>& sessions) {
  const std::vector<std::string> by_importance{"environment", "number", "verdict", "rig",  "valid",
                                               "date (UTC)",  "plan",   "in legs", "file", "notes"};
  Table table = table_of(sessions);
  std::vector<std::string> hidden = table.fit(terminal_width(), by_importance);
  const bool hides_files = std::erase(hidden, "file") > 0;
  print("{}\n", hides_files ? with_files(table.text(), sessions) : table.text());
  if (!hidden.empty())
    print("{}", fmt::format("hidden columns: {}; --json has all\n", fmt::join(hidden, ", ")));
}

template <typename Is>
std::size_t count_of(const std::vector<ListedSession>& sessions, Is is) {
  return static_cast<std::size_t>(
      std::count_if(sessions.begin(), sessions.end(),
                    [&](const ListedSession& session) { return !session.refusal && is(session); }));
}

std::string totals_of(const std::vector<ListedSession>& sessions) {
  const auto verdicts = [&](const char* verdict) {
    return count_of(sessions, [&](const auto& session) { return session.quality.verdict == verdict; });
  };
  std::uint64_t valid = 0;
  for (const ListedSession& session : sessions) valid += session.quality.valid;
  const std::size_t count = count_of(sessions, [](const auto&) { return true; });
  const std::size_t excluded =
      count_of(sessions, [](const auto& session) { return !session.exclusions.empty(); });
  return fmt::format(
      "{} session{}: {} good, {} usable, {} bad; {} SIMULATED; {} valid frames{}\n", count_text(count),
      count == 1 ? "" : "s", verdicts("good"), verdicts("usable"), verdicts("bad"),
      count_of(sessions, [](const auto& session) { return session.header.simulated; }), count_text(valid),
      excluded == 0 ? "" : fmt::format("; {} with excluded frames", count_text(excluded)));
}

/// What else lies in the folders.
void print_journals(const ListOptions& options) {
  const std::vector<std::filesystem::path> journals = dataset::find_journals(options.paths);
  if (journals.empty()) return;
  print("{} journal{}: being recorded, or waiting for thermorig recover {}\n", journals.size(),
        journals.size() == 1 ? "" : "s", printable(shell_word(journals.front().string())));
}

nlohmann::json object_of(const ListedSession& session) {
  if (session.refusal) return refused_file_json(session.file, *session.refusal);
  const RecordingHeader& header = session.header;
  nlohmann::json object = quality_json(session.quality);
  object.update({{"file", session.file.string()},
                 {"uuid", header.uuid},
                 {"environment", session.place.environment},
                 {"acquisition", session.place.acquisition},
                 {"start_time", header.start_time_utc},
                 {"duration_s", session.quality.duration_s},
                 {"plan", header.plan_name},
                 {"for_calibration", session.for_calibration},
                 {"verdict_reasons", session.quality.verdict_reasons},
                 {"simulated", header.simulated},
                 {"licence", header.licence},
                 {"notes", session.notes}});
  object["exclusions"] = nlohmann::json::array();
  for (const Annotation& exclusion : session.exclusions)
    object["exclusions"].push_back(annotation_json(exclusion));
  const std::string world = dataset::world_of(header);
  object["world"] = text_json(world);
  return object;
}

void print_words(const ListOptions& options, const std::vector<ListedSession>& sessions) {
  if (count_of(sessions, [](const auto&) { return true; }) > 0) print_table(sessions);
  print("{}", totals_of(sessions));
  print_journals(options);
}

void print_array(const std::vector<ListedSession>& sessions) {
  nlohmann::json list = nlohmann::json::array();
  for (const ListedSession& session : sessions) list.push_back(object_of(session));
  print_json(list);
}

/// Names each file that is no session. The first one's code.
ExitCode report_refused(const std::vector<ListedSession>& sessions) {
  ExitCode code = ExitCode::ok;
  for (const ListedSession& session : sessions) {
    if (!session.refusal) continue;
    report(*session.refusal, false);
    if (code == ExitCode::ok) code = session.refusal->code();
  }
  return code;
}

std::vector<ListedSession> read_all(const ListOptions& options) {
  const std::vector<std::filesystem::path> files = dataset::find_sessions(options.paths);
  if (!files.empty()) spill::arrays_near(files.front());
  ReadingProgress progress(options.json);
  return dataset::list_sessions(files, std::ref(progress));
}

}  // namespace

ExitCode run(const ListOptions& options) {
  std::vector<ListedSession> all = read_all(options);
  const std::string none = none_text(options, all);
  const std::vector<ListedSession> sessions = chosen_of(options, std::move(all));
  if (options.json) {
    print_array(sessions);
  } else {
    print_words(options, sessions);
    print("{}", none);
  }
  return report_refused(sessions);
}

}  // namespace thermorig::app
