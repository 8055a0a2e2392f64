// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands.h"
#include "existing_file.h"
#include "print/error_output.h"
#include "print/inspect_text.h"
#include "print/output.h"
#include "print/timing_text.h"
#include "thermorig/storage/journal/journal.h"
#include "thermorig/storage/session/trial.h"

namespace thermorig::app {

namespace {

void refuse_journal(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path) || !journal::is_journal(path)) return;
  throw Error(ExitCode::not_a_session, "this is a journal, not yet a session", path.string(),
              "thermorig recover " + path.string());
}

struct Inspected {
  session::Session session;
  session::Quality quality;
  std::vector<std::string> altered;  // attributes that are not as they were written
};

Inspected inspect(const std::filesystem::path& path) {
  require_existing(path);
  refuse_journal(path);
  const sandbox::SealedCopy copy = session::tried_copy(path);
  session::Session session = session::read_session(copy);
  session::Quality quality = session::quality_of(session);
  return {std::move(session), std::move(quality), session::altered_attributes(copy)};
}

std::string words_of(const std::filesystem::path& path, const Inspected& inspected, bool timing) {
  const std::string text = timing ? timing_text(path, inspected.session, inspected.quality)
                                  : text_of(path, inspected.session, inspected.quality);
  return text + altered_text(inspected.altered);
}

nlohmann::json object_of(const std::filesystem::path& path, const Inspected& inspected, bool timing) {
  nlohmann::json object = inspected_json(path, inspected.session, inspected.quality);
  object["altered"] = inspected.altered;
  if (timing) object["timing"] = timing_json(inspected.session, inspected.quality);
  return object;
}

ExitCode code_of(const Inspected& inspected) {
  const bool is_well = inspected.quality.verdict != "bad" && inspected.altered.empty();
  return is_well ? ExitCode::ok : ExitCode::check_failed;
}

nlohmann::json error_json(const std::filesystem::path& path, const Error& error) {
  return {{"file", path.string()},
          {"exit_code", static_cast<int>(error.code())},
          {"error", error.what_happened()},
          {"advice", error.advice()}};
}

}  // namespace

/// Every file is looked at, also after one that is no session: the exit code is that of the first that is not
/// well. With --json one array, an object a file.
ExitCode run(const InspectOptions& options) {
  ExitCode code = ExitCode::ok;
  nlohmann::json list = nlohmann::json::array();
  for (const auto& path : options.files) {
    ExitCode result = ExitCode::ok;
    try {
      const Inspected inspected = inspect(path);
      if (options.check) result = code_of(inspected);
      if (options.json)
        list.push_back(object_of(path, inspected, options.timing));
      else
        print("{}{}", path == options.files.front() ? "" : "\n", words_of(path, inspected, options.timing));
    } catch (const Error& error) {
      report(error, false);
      list.push_back(error_json(path, error));
      result = error.code();
    }
    if (code == ExitCode::ok) code = result;
  }
  if (options.json) print_json(list);
  return code;
}

}  // namespace thermorig::app
