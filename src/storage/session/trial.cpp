// SPDX-License-Identifier: MIT
#include "thermorig/storage/session/trial.h"

#include <sstream>
#include <utility>

#include "tasks.h"
#include "thermorig/storage/sandbox/sandbox.h"

namespace thermorig::session {

namespace {

constexpr std::size_t reading = 0;
constexpr std::size_t naming_altered = 1;

std::string read_it(const sandbox::SealedCopy& copy, std::string_view /*request*/) {
  read_for_nothing(copy);
  return "";
}

/// A line each.
std::string name_altered(const sandbox::SealedCopy& copy, std::string_view /*request*/) {
  std::string lines;
  for (const std::string& path : altered_in(copy)) lines += path + "\n";
  return lines;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

}  // namespace

void try_sessions_first(const std::vector<sandbox::Task>& others) {
  std::vector<sandbox::Task> tasks{read_it, name_altered};
  static_assert(naming_altered + 1 == first_other_task);
  tasks.insert(tasks.end(), others.begin(), others.end());
  sandbox::start(std::move(tasks));
}

sandbox::SealedCopy tried_copy(const std::filesystem::path& path) {
  return tried(sandbox::SealedCopy(path));
}

sandbox::SealedCopy tried(sandbox::SealedCopy copy) {
  if (sandbox::is_started()) sandbox::require_done(sandbox::ask(copy, reading), copy);
  return copy;
}

void require_readable(const sandbox::SealedCopy& copy) {
  if (!sandbox::is_started()) return read_for_nothing(copy);
  sandbox::require_done(sandbox::ask(copy, reading), copy);
}

std::vector<std::string> altered_attributes(const sandbox::SealedCopy& copy) {
  if (!sandbox::is_started()) return altered_in(copy);
  const sandbox::Answer answer = sandbox::ask(copy, naming_altered);
  sandbox::require_done(answer, copy);
  return lines_of(answer.bytes);
}

}  // namespace thermorig::session
