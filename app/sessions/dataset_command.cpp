// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "print/number_json.h"
#include "print/output.h"
#include "print/reading_progress.h"
#include "thermorig/core/code_point.h"
#include "thermorig/io/files/existing.h"
#include "thermorig/io/files/whole_file.h"
#include "thermorig/io/host.h"
#include "thermorig/io/port.h"
#include "thermorig/learning/publication/publication.h"

namespace thermorig::app {

namespace {

namespace fs = std::filesystem;
using publication::Description;
using publication::Entry;
using publication::Fold;

std::vector<Entry> read_entries(const DatasetOptions& options) {
  files::require_existing(options.folder);
  ReadingProgress progress(options.json || !options.part.empty());
  return publication::entries_of(options.folder, options.accept_bad, std::ref(progress));
}

bool is_date(const std::string& text) {
  constexpr std::string_view form = "0000-00-00";
  const auto is_like = [](char c, char like) { return like == '0' ? c >= '0' && c <= '9' : c == like; };
  if (text.size() != form.size() || !std::equal(text.begin(), text.end(), form.begin(), is_like))
    return false;
  const auto number = [&](std::size_t at) { return static_cast<unsigned>(std::stoi(text.substr(at, 2))); };
  return std::chrono::year_month_day(std::chrono::year(std::stoi(text.substr(0, 4))),
                                     std::chrono::month(number(5)), std::chrono::day(number(8)))
      .ok();
}

/// JSON and YAML hold nothing else.
void require_utf8(const DatasetOptions& options) {
  std::vector<std::string> words = options.authors;
  words.insert(words.end(),
               {options.title, options.description, options.licence, options.version, options.url});
  for (const std::string& text : words)
    if (!is_utf8(text))
      throw Error(ExitCode::bad_usage, "is not UTF-8: " + printable(text), "", "locale (of the terminal)");
}

publication::Terms terms_of(const DatasetOptions& options) {
  require_utf8(options);
  const std::string today = io::utc_text(io::now(), io::realtime_offset_ns()).substr(0, 10);
  if (!options.date.empty() && !is_date(options.date))
    throw Error(ExitCode::bad_usage, "--date is not a day of the form 2026-11-23", "", "--date " + today);
  return {.title = options.title,
          .description = options.description,
          .licence = options.licence,
          .authors = options.authors,
          .version = options.version,
          .url = options.url,
          .date = options.date.empty() ? today : options.date};
}

/// Of descriptions that are there only files are written over, and only where that is asked for.
void require_writable(const DatasetOptions& options, const std::vector<Description>& descriptions) {
  for (const Description& description : descriptions) {
    const fs::path path = options.folder / description.name;
    std::error_code hidden;
    const fs::file_status status = fs::symlink_status(path, hidden);
    if (fs::exists(status) && !options.replace)
      throw Error(ExitCode::storage, "it exists already", path.string(),
                  "--replace writes over the descriptions");
    if (fs::exists(status) && !fs::is_regular_file(status))
      throw Error(ExitCode::storage, "its place is taken by what is no file: a link, a folder, a device",
                  path.string(), "move it away");
  }
}

ExitCode build(const DatasetOptions& options) {
  const publication::Terms terms = terms_of(options);
  const std::vector<Entry> entries = read_entries(options);
  std::vector<Description> descriptions = publication::describe(terms, entries);
  descriptions.push_back({publication::sums_name, publication::sums_text(entries, descriptions)});
  require_writable(options, descriptions);
  for (const Description& description : descriptions)
    files::write_whole(options.folder / description.name, description.text,
                       "the description of the data set");
  const auto simulated = static_cast<std::size_t>(std::count_if(
      entries.begin(), entries.end(), [](const Entry& entry) { return entry.session.header.simulated; }));
  const std::string licence = publication::licence_of(terms, entries);
  if (options.json) {
    nlohmann::json object{{"folder", options.folder.string()},
                          {"sessions", entries.size()},
                          {"simulated", simulated},
                          {"folds", publication::leave_one_out(entries).size()},
                          {"files", nlohmann::json::array()}};
    object["licence"] = text_json(licence);
    for (const Description& description : descriptions) object["files"].push_back(description.name);
    print_json(object);
    return ExitCode::ok;
  }
  print("data set  {}: {} sessions{}, licence {}\n", printable(options.folder.string()), entries.size(),
        simulated == 0 ? "" : fmt::format(", {} of them SIMULATED", simulated),
        licence.empty() ? "NOT STATED (--licence)" : printable(licence));
  for (const Description& description : descriptions) print("written   {}\n", description.name);
  print("next      read DATA_CARD.md, then thermorig dataset verify {}\n",
        printable(options.folder.string()));
  return ExitCode::ok;
}

ExitCode verify(const DatasetOptions& options) {
  files::require_existing(options.folder);
  const std::vector<publication::Difference> differences = publication::verify(options.folder);
  nlohmann::json list = nlohmann::json::array();
  for (const publication::Difference& difference : differences) {
    list.push_back({{"path", difference.path}, {"what", difference.what}});
    if (!options.json) print("{}  {}\n", printable(difference.path), difference.what);
  }
  if (options.json) print_json({{"folder", options.folder.string()}, {"differences", list}});
  if (!options.json && differences.empty()) print("every file is as it was when the data set was built\n");
  return differences.empty() ? ExitCode::ok : ExitCode::check_failed;
}

std::vector<Fold> folds_of(const DatasetOptions& options, const std::vector<Entry>& entries) {
  std::vector<Fold> folds = publication::leave_one_out(entries);
  if (folds.empty())
    throw Error(ExitCode::bad_usage, "there is one environment only, and none can be left out",
                options.folder.string(), "thermorig list " + shell_word(options.folder.string()));
  if (options.environment.empty()) return folds;
  std::string names;
  for (const Fold& fold : folds) names += (names.empty() ? "" : ", ") + fold.environment;
  std::erase_if(folds, [&](const Fold& fold) { return fold.environment != options.environment; });
  if (folds.empty())
    throw Error(ExitCode::bad_usage, "there is no session of " + options.environment, options.folder.string(),
                names);
  return folds;
}

std::vector<std::string> in_folder(const fs::path& folder, const std::vector<std::string>& paths) {
  std::vector<std::string> named;
  for (const std::string& path : paths) named.push_back((folder / path).string());
  return named;
}

ExitCode split(const DatasetOptions& options) {
  const std::vector<Fold> folds = folds_of(options, read_entries(options));
  nlohmann::json list = nlohmann::json::array();
  Table table({"test", ">recordings to learn from", ">to be judged by"});
  for (const Fold& fold : folds) {
    list.push_back({{"test_environment", fold.environment},
                    {"training", in_folder(options.folder, fold.training)},
                    {"test", in_folder(options.folder, fold.test)}});
    table.add({fold.environment, count_text(fold.training.size()), count_text(fold.test.size())});
  }
  if (!options.part.empty() && !options.json) {
    for (const std::string path : list.front()[options.part]) write_to(stdout, printable(path) + "\n");
    return ExitCode::ok;
  }
  if (options.json)
    print_json({{"kind", "leave one environment out"}, {"folds", list}});
  else
    print("{}", table.text());
  return ExitCode::ok;
}

}  // namespace

ExitCode run(const DatasetOptions& options) {
  switch (options.action) {
    case DatasetAction::verify:
      return verify(options);
    case DatasetAction::split:
      return split(options);
    case DatasetAction::build:
      break;
  }
  return build(options);
}

}  // namespace thermorig::app
