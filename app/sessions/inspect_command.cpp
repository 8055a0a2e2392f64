// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands.h"
#include "print/error_output.h"
#include "print/inspect_text.h"
#include "print/map_text.h"
#include "print/output.h"
#include "print/timing_text.h"
#include "session_files.h"
#include "session_page.h"
#include "thermorig/io/spill/spill.h"
#include "thermorig/storage/session/trial.h"

namespace thermorig::app {

namespace {

struct Inspected {
  session::Overview overview;
  std::vector<std::string> altered;  // attributes that are not as they were written
};

Inspected inspect(const std::filesystem::path& path) {
  refuse_journal(path);
  spill::arrays_near(path);
  const session::StoredFile file(path);
  session::Overview overview = session::read_overview(file);
  return {std::move(overview), session::altered_attributes(file)};
}

std::string words_of(const std::filesystem::path& path, const Inspected& inspected, bool timing) {
  const auto& [session, quality] = inspected.overview;
  const std::string text = timing ? timing_text(path, session, quality) : text_of(path, session, quality);
  return text + altered_text(inspected.altered);
}

nlohmann::json object_of(const std::filesystem::path& path, const Inspected& inspected, bool timing) {
  const auto& [session, quality] = inspected.overview;
  nlohmann::json object = inspected_json(path, session, quality);
  object["altered"] = inspected.altered;
  if (timing) object["timing"] = timing_json(session, quality);
  return object;
}

/// What is called a map is looked at as one, so that a damaged one is said to be that.
bool names_map(const std::filesystem::path& file) {
  return file.extension() == ".map" || map_file::is_map(file);
}

void refuse_session_words(const InspectOptions& options, const std::filesystem::path& map) {
  const std::string word = !options.html.empty()    ? "--html"
                           : !options.plots.empty() ? "--plots"
                           : options.check          ? "--check"
                           : options.timing         ? "--timing"
                                                    : "";
  if (word.empty()) return;
  throw Error(ExitCode::bad_usage, word + " is for sessions, and this is a map", map.string(),
              "thermorig inspect " + shell_word(map.string()));
}

ExitCode code_of(const Inspected& inspected) {
  const bool is_well = inspected.overview.quality.verdict != "bad" && inspected.altered.empty();
  return is_well ? ExitCode::ok : ExitCode::check_failed;
}

/// The sessions of a command, one after another.
class Inspection {
 public:
  explicit Inspection(const InspectOptions& options) : options_(options) {}

  /// A file or a folder.
  void look_at(const std::filesystem::path& path) {
    try {
      for (const auto& file : session_files_at(path)) look_at_file(file);
    } catch (const Error& error) {
      refuse(path, error);
    }
  }

  ExitCode end() const {
    if (options_.json) print_json(list_);
    return code_;
  }

 private:
  void look_at_file(const std::filesystem::path& file) {
    try {
      names_map(file) ? tell_map(file) : tell(file, inspect(file));
    } catch (const Error& error) {
      refuse(file, error);
    }
  }

  void tell(const std::filesystem::path& file, const Inspected& inspected) {
    if (options_.check) take(code_of(inspected));
    if (options_.json)
      list_.push_back(object_of(file, inspected, options_.timing));
    else
      print_text(words_of(file, inspected, options_.timing));
  }

  void tell_map(const std::filesystem::path& file) {
    refuse_session_words(options_, file);
    const map_file::StoredMap stored = map_file::read_map(file);
    if (options_.json)
      list_.push_back(map_json(file, stored));
    else
      print_text(map_text(file, stored));
  }

  void print_text(const std::string& text) {
    print("{}{}", is_first_ ? "" : "\n", text);
    is_first_ = false;
  }

  void refuse(const std::filesystem::path& path, const Error& error) {
    report(error, false);
    list_.push_back(refused_file_json(path, error));
    take(error.code());
  }

  void take(ExitCode code) {
    if (code_ == ExitCode::ok) code_ = code;
  }

  const InspectOptions& options_;
  ExitCode code_ = ExitCode::ok;
  nlohmann::json list_ = nlohmann::json::array();
  bool is_first_ = true;
};

}  // namespace

/// Every file is looked at, also after one that is no session: the exit code is that of the first that is not
/// well. With --json one array, an object a file.
ExitCode run(const InspectOptions& options) {
  if (!options.html.empty() && !options.plots.empty())
    throw Error(ExitCode::bad_usage, "--html and --plots exclude each other", "", "run one, then the other");
  if (!options.html.empty() || !options.plots.empty()) {
    for (const auto& path : options.paths)
      if (names_map(path)) refuse_session_words(options, path);
    return options.html.empty() ? write_session_plots(options) : write_session_page(options);
  }
  Inspection inspection(options);
  for (const auto& path : options.paths) inspection.look_at(path);
  return inspection.end();
}

}  // namespace thermorig::app
