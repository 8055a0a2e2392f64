// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "print/output.h"
#include "thermorig/io/files/existing.h"
#include "thermorig/rig/recording/finalise.h"

namespace thermorig::app {

namespace {

using rig::RecoveryKind;
using rig::RecoveryResult;

std::string name_of(RecoveryKind kind) {
  static constexpr std::array names{"recovered", "already there", "empty", "failed", "in use", "removed"};
  return names[static_cast<std::size_t>(kind)];
}

ExitCode code_of(const RecoveryResult& result) {
  if (result.kind == RecoveryKind::failed) return result.code;
  if (result.kind == RecoveryKind::in_use) return ExitCode::no_permission;
  return result.bytes_ignored > 0 ? ExitCode::finished_lossy : ExitCode::ok;
}

std::string loss_text(const RecoveryResult& result) {
  if (result.bytes_ignored == 0) return "nothing was lost";
  const std::string bytes = bytes_text(result.bytes_ignored);
  return result.of_cut_session
             ? bytes + " of the cut file are missing; move that file out of the folder"
             : bytes + " at the torn end could not be read and are lost; the journal is kept";
}

std::string text_of(const RecoveryResult& result) {
  if (result.session.empty())
    return fmt::format("{:<14} {}\n               {}\n", name_of(result.kind),
                       printable(result.source.string()), printable(result.message));
  return fmt::format("{:<14} {}\n               {} frames, {} valid, from {} chunks; {}\n",
                     name_of(result.kind), printable(result.session.string()), count_text(result.frames),
                     count_text(result.valid), count_text(result.chunks), loss_text(result));
}

nlohmann::json json_of(const RecoveryResult& result) {
  return {{"result", name_of(result.kind)},
          {"source", result.source.string()},
          {"session", result.session.string()},
          {"frames", result.frames},
          {"frames_valid", result.valid},
          {"chunks", result.chunks},
          {"bytes_lost", result.bytes_ignored},
          {"message", result.message},
          {"exit_code", static_cast<int>(code_of(result))}};
}

/// The worst of all: the disk before a failure before a recording in progress before a loss.
ExitCode code_of(const std::vector<RecoveryResult>& results) {
  for (const ExitCode code : {ExitCode::storage, ExitCode::not_a_session, ExitCode::failed,
                              ExitCode::no_permission, ExitCode::finished_lossy})
    for (const RecoveryResult& result : results)
      if (code_of(result) == code) return code;
  return ExitCode::ok;
}

void print_text(const std::filesystem::path& path, const std::vector<RecoveryResult>& results) {
  if (results.empty())
    print("nothing to recover in {}: no journal is left there\n", printable(path.string()));
  for (const RecoveryResult& result : results) print("{}", text_of(result));
  for (const RecoveryResult& result : results) {
    if (result.session.empty()) continue;
    print("\nnext  thermorig inspect {}\n", printable(shell_word(result.session.string())));
    break;
  }
}

}  // namespace

ExitCode run(const RecoverOptions& options) {
  std::error_code hidden;  // a journal may be gone, and its session there; a link leads somewhere
  if (std::filesystem::is_symlink(std::filesystem::symlink_status(options.path, hidden)))
    files::require_existing(options.path);
  const std::vector<RecoveryResult> results = rig::recover(options.path);
  if (options.json) {
    nlohmann::json list = nlohmann::json::array();
    for (const RecoveryResult& result : results) list.push_back(json_of(result));
    print_json(list);
  } else {
    print_text(options.path, results);
  }
  return code_of(results);
}

}  // namespace thermorig::app
