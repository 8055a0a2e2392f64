// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands.h"
#include "error_output.h"
#include "inspect_text.h"
#include "output.h"
#include "thermorig/journal/journal.h"

namespace thermorig::app {

namespace {

void refuse_journal(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path) || !journal::is_journal(path)) return;
  throw Error(ExitCode::not_a_session, "this is a journal, not yet a session", path.string(),
              "thermorig recover " + path.string());
}

ExitCode inspect(const std::filesystem::path& path, const InspectOptions& options) {
  refuse_journal(path);
  const session::Session session = session::read_session(path);
  const session::Quality quality = session::quality_of(session);
  if (options.json)
    print_json(json_of(path, session, quality));
  else
    fmt::print("{}", text_of(path, session, quality));
  return options.check && quality.verdict == "bad" ? ExitCode::check_failed : ExitCode::ok;
}

}  // namespace

/// Every file is looked at, also after one that is no session: the exit code is that of the first that is not
/// well.
ExitCode run(const InspectOptions& options) {
  ExitCode code = ExitCode::ok;
  for (std::size_t i = 0; i < options.files.size(); ++i) {
    if (i > 0 && !options.json) fmt::print("\n");
    ExitCode result = ExitCode::ok;
    try {
      result = inspect(options.files[i], options);
    } catch (const Error& error) {
      report(error, options.json);
      result = error.code();
    }
    if (code == ExitCode::ok) code = result;
  }
  return code;
}

}  // namespace thermorig::app
