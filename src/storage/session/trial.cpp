// SPDX-License-Identifier: MIT
#include "thermorig/storage/session/trial.h"

#include <utility>

#include "tasks.h"
#include "thermorig/storage/sandbox/sandbox.h"

namespace thermorig::session {

namespace {

constexpr std::size_t reading = 0;
constexpr std::size_t naming_altered = 1;

std::vector<std::string> lines_of_reading(const sandbox::SealedCopy& copy) {
  read_for_nothing(copy);
  return {};
}

}  // namespace

void try_sessions_first() {
  sandbox::start({lines_of_reading, altered_in});
}

sandbox::SealedCopy tried_copy(const std::filesystem::path& path) {
  return tried(sandbox::SealedCopy(path));
}

sandbox::SealedCopy tried(sandbox::SealedCopy copy) {
  if (sandbox::is_started()) sandbox::require_harmless(sandbox::ask(copy, reading).end, copy);
  return copy;
}

void require_readable(const sandbox::SealedCopy& copy) {
  const auto end = sandbox::is_started() ? sandbox::ask(copy, reading).end : sandbox::End::refused;
  sandbox::require_harmless(end, copy);
  if (end != sandbox::End::done) read_for_nothing(copy);  // says why it is refused; or nobody tries files
}

std::vector<std::string> altered_attributes(const sandbox::SealedCopy& copy) {
  if (!sandbox::is_started()) return altered_in(copy);
  sandbox::Answer answer = sandbox::ask(copy, naming_altered);
  sandbox::require_harmless(answer.end, copy);
  if (answer.end == sandbox::End::refused) return altered_in(copy);  // says why
  return std::move(answer.lines);
}

}  // namespace thermorig::session
